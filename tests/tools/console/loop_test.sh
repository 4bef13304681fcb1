#!/usr/bin/env bash
# From uncertain contacts to a better model, in Debian's Chromium: loop_test.mjs
# says how.
#
#   loop_test.sh BIN WORK   programs in BIN; packages go to WORK
#
# Exits with 77 if there is no Chromium or no npm.
set -euo pipefail
source_dir=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
TACTUS_MATERIALS=$source_dir/../../../core/sim/model/materials.csv
export TACTUS_MATERIALS
exec "$source_dir/page_test.sh" "$1" "$2" loop_test.mjs
