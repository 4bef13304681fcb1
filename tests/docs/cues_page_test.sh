#!/usr/bin/env bash
# docs/cues.md has the table that trainctl prints.
#
#   tests/docs/cues_page_test.sh TRAINCTL
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
diff <("$1" cues --markdown) <(sed -n '/^| cue | needs |/,/^$/{/^$/d;p}' docs/cues.md)
