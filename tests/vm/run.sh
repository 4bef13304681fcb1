#!/usr/bin/env bash
# Runs the CAN and USB drivers on a real kernel, in a guest of QEMU: vcan0, two
# CAN cards on one bus, and a gs_usb adapter that a program plays for the guest's
# own USB host. The machine needs neither CAN nor USB.
#
#   tests/vm/run.sh [--build=build/release]
#
# Needs the packages qemu-system-x86, busybox-static and iproute2, and downloads
# Debian's kernel package (70 MB, not installed) into build/vm. The guest sees
# the host's files read-only, so it runs the programs of the build as they are.
# It boots with TCG and counts instructions instead of time: a slow or busy host
# makes the run longer, not the guest's times, unless the guest waits for files.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

build=build/release
for arg in "$@"; do
  case "$arg" in
    --build=*) build=${arg#--build=} ;;
    -h | --help) sed -n '2,/^set /{/^set /d;s/^# \{0,1\}//;p}' "$0"; exit 0 ;;
    *) echo "run.sh: unknown option '$arg' (try --help)" >&2; exit 2 ;;
  esac
done
for program in qemu-system-x86_64 busybox ip; do
  if ! command -v "$program" >/dev/null; then
    echo "tests/vm: skipped, needs $program (packages qemu-system-x86," \
      "busybox-static, iproute2)"
    exit 77
  fi
done
build=$(realpath "$build")
for program in bin/tactusd bin/tactus-stream bin/tactus-fakeskin \
  tests/kernel_can_test tests/kernel_usb_test; do
  if [[ ! -x $build/$program ]]; then
    echo "tests/vm: $build/$program is not built" >&2
    exit 1
  fi
done

# The kernel and its modules, from the package that linux-image-amd64 names.
work=build/vm
mkdir -p "$work"
package=$(apt-cache depends linux-image-amd64 |
  sed -n 's/^ *Depends: \(linux-image-.*\)$/\1/p' | head -n 1)
if [[ -z $package ]]; then
  echo "tests/vm: skipped, apt knows no linux-image-amd64"
  exit 77
fi
kernel=$work/$package
parts=('./boot/vmlinuz*')
for folder in net/can net/9p drivers/net/can drivers/virtio drivers/usb \
  fs/9p fs/netfs fs/fscache fs/configfs; do
  parts+=("./lib/modules/*/kernel/$folder/*")
done
if [[ $(cat "$kernel/complete" 2>/dev/null) != "${parts[*]}" ]]; then
  (cd "$work" && apt-get download "$package" >/dev/null)
  mkdir -p "$kernel"
  dpkg-deb --fsys-tarfile "$work/$package"_*.deb |
    tar -x -C "$kernel" --wildcards "${parts[@]}"
  rm -f "$work/$package"_*.deb
  echo "${parts[*]}" >"$kernel/complete"
fi

# A file system in memory: busybox, the modules in the order of their loading,
# and what runs first.
root=$work/root
rm -rf "$root"
mkdir -p "$root/bin" "$root/modules" "$root/host" "$root/proc" "$root/dev"
cp "$(command -v busybox)" "$root/bin/busybox"
modules=(virtio_ring virtio virtio_pci_legacy_dev virtio_pci_modern_dev
  virtio_pci netfs fscache 9pnet 9pnet_virtio 9p can can-dev can-raw vcan
  sja1000 kvaser_pci usb-common usbcore udc-core dummy_hcd configfs libcomposite
  usb_f_fs gs_usb)
number=10
for module in "${modules[@]}"; do
  # Some are built in.
  file=$(find "$kernel/lib/modules" -name "$module.ko" | head -n 1)
  [[ -z $file ]] || cp "$file" "$root/modules/$number-$module.ko"
  number=$((number + 1))
done
cat >"$root/init" <<EOF
#!/bin/busybox sh
b=/bin/busybox
\$b mount -t proc proc /proc
\$b mount -t devtmpfs dev /dev
for module in /modules/*; do \$b insmod "\$module"; done
\$b mount -t 9p -o trans=virtio,version=9p2000.L,ro,msize=262144,cache=loose \
  host /host
\$b mount -t proc proc /host/proc
\$b mount -t sysfs sys /host/sys
\$b mount --bind /dev /host/dev
\$b mount -t tmpfs tmp /host/tmp
\$b chroot /host /bin/bash '$PWD/tests/vm/guest.sh' '$build' >/dev/ttyS0 2>&1
\$b poweroff -f
EOF
chmod +x "$root/init"
(cd "$root" && find . | busybox cpio -o -H newc 2>/dev/null) >"$work/initramfs"

log=$work/log
qemu-system-x86_64 -accel tcg -icount shift=0,sleep=off -cpu max -m 2048 \
  -nographic -no-reboot -nodefaults -serial stdio \
  -kernel "$kernel"/boot/vmlinuz* -initrd "$work/initramfs" \
  -append "console=ttyS0 quiet panic=-1" \
  -object can-bus,id=bus0 -device kvaser_pci,canbus=bus0 \
  -device kvaser_pci,canbus=bus0 \
  -fsdev local,id=host,path=/,readonly=on,security_model=none,multidevs=remap \
  -device virtio-9p-pci,fsdev=host,mount_tag=host </dev/null | tee "$log"
if ! grep -q '^guest: all passed' "$log"; then
  echo "tests/vm: FAILED" >&2
  exit 1
fi
echo "tests/vm: all passed"
