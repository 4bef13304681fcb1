#!/usr/bin/env bash
# tactus-fakeskin --skin=anyskin and the programs that read it, as
# docs/drivers.md shows it, in real time.
#
#   tests/tools/fakeskin/anyskin_check.sh BUILD_FOLDER
set -euo pipefail
bin=$(cd "$1/bin" && pwd)
work=$(mktemp -d)
cd "$work"
skin=
stop() {
  if [[ -n $skin ]]; then
    kill "$skin" 2>/dev/null || true
    wait "$skin" 2>/dev/null || true
  fi
  rm -rf "$work"
}
trap stop EXIT
fail() {
  echo "$*" >&2
  exit 1
}

"$bin/tactus-fakeskin" --skin=anyskin --port=anyskin --rate-hz=200 \
  --contacts=4 --first-after=60 >skin.txt &
skin=$!
for ((i = 0; i < 600; i++)); do
  [[ -s skin.txt ]] && break
  sleep 0.1
done
grep -qx "playing 4 contacts on anyskin" skin.txt
# It measures the rate, too, and refuses a skin that is touched. A machine that
# stands still makes the rate wrong, so it gets three tries.
for ((i = 0; i < 3; i++)); do
  "$bin/trainctl" skin calibrate --driver=anyskin --port=anyskin \
    --rate-hz=200 --device-id=fake --frames=400 --out=cal.json \
    >calibrate.txt 2>&1 && break
done
cat calibrate.txt
grep -q "fake: anyskin-5, 3 x 3 taxels at 200 Hz" calibrate.txt
grep -q "dead taxels: none; stuck: none; noisy: none" calibrate.txt
# The deviation is that of the noise, 2 uT.
grep -Eq "deviations: median (1\.[6-9]|2\.[0-4])" calibrate.txt
# A second one does not take its link.
if "$bin/tactus-fakeskin" --skin=anyskin --port=anyskin 2>second.txt; then
  fail "two skins on one link"
fi
grep -q "anyskin: exists" second.txt
kill "$skin"
wait "$skin" || fail "tactus-fakeskin failed"
skin=
[[ ! -e anyskin && ! -L anyskin ]] || fail "the link is still there"
# Flags that do not belong together.
for flags in "--skin=anyskin --interface=vcan0" "--skin=xela" \
  "--interface=vcan0 --port=anyskin" "--interface=vcan0 --rate-hz=200"; do
  # shellcheck disable=SC2086
  if "$bin/tactus-fakeskin" $flags 2>refused.txt; then
    fail "accepted: $flags"
  fi
  grep -q "it must be" refused.txt || fail "no reason for: $flags"
done
