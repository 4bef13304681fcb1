#!/usr/bin/env bash
# docs/make-api.sh: the reference of the C++ interface is written without a
# warning, and a wrong comment is one. docs/api.md names each public header.
#
#   tests/docs/api_page_test.sh
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() { echo "api_page_test: $1" >&2; exit 1; }

docs/make-api.sh "$work/api"
for name in Client Classifier Stream MockStream Driver; do
  [[ -s $work/api/html/classtactus_1_1$name.html ]] || fail "no page of $name"
done
for header in client/include/tactus/*.h; do
  grep -q "^| \`${header#client/include/}\` |" docs/api.md ||
    fail "docs/api.md does not name $header"
done

mkdir -p "$work/tree/client"
cp -r docs "$work/tree/"
cp -r client/include "$work/tree/client/"
sed -i 's|^class Client {|// See \\ref NoSuchThing.\nclass Client {|' \
  "$work/tree/client/include/tactus/client.h"
if "$work/tree/docs/make-api.sh" "$work/bad" >"$work/log" 2>&1; then
  fail "a reference to nothing is no warning"
fi
grep -q NoSuchThing "$work/log" || fail "the warning does not name it"
