#!/usr/bin/env bash
# Bundles the console's page.
#
#   build.sh OUT WORK   writes index.html, app.js, app.css and favicon.svg to
#                       OUT; WORK keeps the packages of the lock file. Fails if
#                       the page is larger than 150 kB compressed
set -euo pipefail
source_dir=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
mkdir -p "$1" "$2"
out=$(cd "$1" && pwd)
work=$(cd "$2" && pwd)

# The source folder stays as it is.
cp "$source_dir"/{package.json,package-lock.json,tsconfig.json,.npmrc} "$work/"
rm -rf "$work/src"
cp -r "$source_dir/src" "$work/src"
cd "$work"
if ! cmp -s package-lock.json installed-lock.json; then
  npm ci --silent
  cp package-lock.json installed-lock.json
fi
npx --no-install tsc
npx --no-install esbuild src/main.ts --bundle --minify --target=es2020 \
  --log-level=warning --outfile="$out/app.js"
npx --no-install esbuild src/app.css --bundle --minify --log-level=warning \
  --outfile="$out/app.css"
cp "$source_dir/favicon.svg" "$out/"
# A page that grew without notice takes seconds on a slow network.
compressed=$(cat "$out"/app.{js,css} "$source_dir/index.html" "$out/favicon.svg" |
  gzip -9 | wc -c)
if [[ $compressed -gt 150000 ]]; then
  echo "build.sh: the page has $compressed bytes compressed; at most 150000" >&2
  exit 1
fi
# Last, because a build takes it as the sign that all is there.
cp "$source_dir/index.html" "$out/"
