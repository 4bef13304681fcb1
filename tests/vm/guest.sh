#!/usr/bin/env bash
# Runs in the guest of tests/vm/run.sh, with the host's files.
#
#   guest.sh BUILD
set -euo pipefail
build=$1
TIMEFORMAT="guest: tactus-stream took %U s + %S s of processor time"
PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin

fail() {
  echo "guest: FAILED: $*"
  exit 1
}

ip link set lo up
ip link add vcan0 type vcan
ip link set vcan0 up
for card in can0 can1; do
  ip link set "$card" up type can bitrate 1000000 restart-ms 100
done

"$build/tests/kernel_can_test" || fail kernel_can_test

# A fake skin, the driver and a server, over vcan0 and over the two cards.
"$build/bin/tactusd" --listen=unix:/tmp/tactusd --log-level=error &
for ((i = 0; i < 600; i++)); do
  [[ -S /tmp/tactusd ]] && break
  sleep 0.1
done
echo '{"layout": "cody-forearm"}' >/tmp/cody.json
for ends in vcan0:vcan0 can0:can1; do
  "$build/bin/tactus-fakeskin" --interface="${ends%:*}" --contacts=4 \
    >/tmp/skin &
  skin=$!
  for ((i = 0; i < 600; i++)); do
    grep -q playing /tmp/skin && break
    sleep 0.1
  done
  sleep 0.5
  time "$build/bin/tactus-stream" --model=models/no-poses --driver=icub-can --interface="${ends#*:}" \
    --server=unix:/tmp/tactusd --boards=1,2 --layout=/tmp/cody.json \
    --scale=0.01 --period-ms=10 --seconds=20 --json >/tmp/out ||
    fail "tactus-stream on $ends"
  kill "$skin"
  wait "$skin" || true
  echo "guest: $ends"
  cat /tmp/skin /tmp/out
  tail -n 1 /tmp/out | grep -q '"lost":0' || fail "$ends lost frames"
  tail -n 1 /tmp/out | grep -q '"overwritten":0' || fail "$ends overwrote frames"
  grep -q '"contact":1,' /tmp/out || fail "$ends felt no contact"
done
echo "guest: all passed"
