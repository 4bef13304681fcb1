#!/usr/bin/env bash
# Runs in the guest of tests/vm/run.sh, with the host's files.
#
#   guest.sh BUILD
set -euo pipefail
build=$1
here=$(dirname "${BASH_SOURCE[0]}")
gadget=/sys/kernel/config/usb_gadget/skin
function=/tmp/skin-function
TIMEFORMAT="guest: tactus-stream took %U s + %S s of processor time"
PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin

fail() {
  echo "guest: FAILED: $*"
  exit 1
}

# await COMMAND...: until it succeeds, at most a minute.
await() {
  for ((i = 0; i < 600; i++)); do
    ! "$@" || return 0
    sleep 0.1
  done
  fail "nothing came of: $*"
}

# Prints the CAN interface of the kernel's gs_usb driver.
adapter_interface() {
  local name
  for name in /sys/class/net/*; do
    [[ $(readlink "$name/device/driver") == */gs_usb ]] || continue
    basename "$name"
    return 0
  done
  return 1
}

# stream NAME SKIN DRIVER: 32 triangles at 100 Hz, touched by simulated
# contacts, from `tactus-fakeskin SKIN` to tactusd by `tactus-stream DRIVER`.
# DRIVER may contain ADAPTER, the interface of the kernel's gs_usb driver.
stream() {
  local name=$1 skin_flags driver_flags skin interface number label
  read -ra skin_flags <<<"$2"
  tactus-fakeskin "${skin_flags[@]}" --contacts=6 \
    --first-after=6 >/tmp/skin &
  skin=$!
  await grep -q playing /tmp/skin
  if [[ $2 == --function-fs* ]]; then
    await adapter_interface >/tmp/interface
    interface=$(cat /tmp/interface)
    if [[ $3 == *ADAPTER* ]]; then
      # Linux 6.1 has no restart-ms for these adapters.
      ip link set "$interface" up type can bitrate 1000000
    fi
  fi
  read -ra driver_flags <<<"${3/ADAPTER/${interface:-}}"
  sleep 0.5
  time tactus-stream --model=models/no-poses "${driver_flags[@]}" \
    --server=unix:/tmp/tactusd --boards=1,2 --layout=/tmp/cody.json \
    --scale=0.01 --period-ms=10 --seconds=20 --json >/tmp/out ||
    fail "tactus-stream over $name"
  kill "$skin"
  wait "$skin" || true
  echo "guest: $name"
  cat /tmp/skin /tmp/out
  tail -n 1 /tmp/out | grep -q '"lost":0' || fail "$name lost frames"
  tail -n 1 /tmp/out | grep -q '"overwritten":0' ||
    fail "$name overwrote frames"
  ! grep -q 'did not fetch' /tmp/skin || fail "$name did not fetch frames"
  # The end of the stream may cut off a third contact.
  for number in 1 2; do
    label=$(sed -n "s/^contact $number  //p" /tmp/skin)
    grep "\"contact\":$number," /tmp/out | grep -q "\"answer\":\"$label\"" ||
      fail "$name: contact $number is $label"
  done
}

# The guest's time runs ahead while it waits for the host's files, and more so if
# the host is busy. So what runs beside a skin is in the guest's memory.
mkdir /tmp/bin /tmp/lib
for program in bin/tactus{d,-stream,-fakeskin} tests/kernel_{can,usb}_test; do
  cp "$build/$program" /tmp/bin
  ldd "$build/$program" | sed -n 's/.* => \(\/[^ ]*\).*/\1/p' >/tmp/libraries
  xargs cp -u -t /tmp/lib </tmp/libraries
done
export PATH=/tmp/bin:$PATH LD_LIBRARY_PATH=/tmp/lib

ip link set lo up
ip link add vcan0 type vcan
ip link set vcan0 up
for card in can0 can1; do
  ip link set "$card" up type can bitrate 1000000 restart-ms 100
done
usb=yes
for module in dummy_hcd libcomposite usb_f_fs gs_usb; do
  if [[ ! -d /sys/module/$module ]]; then
    echo "guest: skipped USB: this kernel has no module $module"
    usb=no
  fi
done
if [[ $usb == yes ]]; then
  mount -t configfs config /sys/kernel/config
  "$here/make-gadget.sh" "$gadget" "$function"
fi

kernel_can_test || fail kernel_can_test
kernel_usb_test || fail kernel_usb_test

tactusd --listen=unix:/tmp/tactusd --log-level=error &
await test -S /tmp/tactusd
echo '{"layout": "cody-forearm"}' >/tmp/cody.json
stream vcan0 --interface=vcan0 "--driver=icub-can --interface=vcan0"
stream "can0 to can1" --interface=can0 "--driver=icub-can --interface=can1"
if [[ $usb == yes ]]; then
  played="--function-fs=$function --gadget=$gadget"
  stream "USB by libusb" "$played" --driver=icub-usb
  stream "USB by the kernel's gs_usb" "$played" \
    "--driver=icub-can --interface=ADAPTER"
fi
echo "guest: all passed"
