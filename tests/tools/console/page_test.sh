#!/usr/bin/env bash
# The console's page in Debian's Chromium: its states, against a made-up
# console, and what people do, against a real server and robots.
#
#   page_test.sh BIN WORK           programs in BIN; packages and pictures go to
#                                   WORK
#   BENCH_SECONDS=60 page_test.sh BIN WORK page_bench.mjs
#                                   prints how long frames take to the screen
#   page_test.sh BIN WORK robots_bench.mjs
#                                   prints how long robots wait meanwhile
#   page_test.sh BIN WORK walk_test.mjs
#                                   prints how many clicks a newcomer needs
#   RECORD=1 page_test.sh BIN WORK pictures_test.mjs
#                                   keeps new pictures in tests/golden/console
#
# Exits with 77 if there is no Chromium or no npm.
set -euo pipefail
source_dir=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
bin=$(cd "$1" && pwd)
mkdir -p "$2"
cd "$2"
for program in chromium npm node; do
  command -v "$program" >/dev/null || {
    echo "page_test: $program is not installed"
    exit 77
  }
done
if [[ ! -e $bin/../share/tactus/console/index.html ]]; then
  echo "page_test: the page is not built" >&2
  exit 1
fi
# The source folder stays as it is.
cp "$source_dir"/{package.json,package-lock.json,.npmrc,*.mjs} .
if ! cmp -s package-lock.json installed-lock.json; then
  npm ci --silent
  cp package-lock.json installed-lock.json
fi
export TACTUS_BIN=$bin
TACTUS_PICTURES=$(cd "$source_dir/../.." && pwd)/golden/console
export TACTUS_PICTURES
TACTUS_DEPLOY=$(cd "$source_dir/../../../deploy" && pwd)
export TACTUS_DEPLOY
if [[ $# -gt 2 ]]; then
  node "$3"
else
  node states_test.mjs "$bin/../share/tactus/console" states
  node --test page_test.mjs
  node --test pages_test.mjs
  node --test import_test.mjs
  node --test contacts_test.mjs
  node --test slow_network_test.mjs
  node --test tls_test.mjs
  node --test hostile_test.mjs
  node --test foxglove_test.mjs
fi
