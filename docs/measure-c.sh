#!/usr/bin/env bash
# What the C interface weighs (docs/c.md): bytes of code and memory of a program
# with one model in it, which answers a touch.
#
#   docs/measure-c.sh [BUILD [COMPILER-PREFIX [RUNNER...]]]
#   docs/measure-c.sh build/arm64 aarch64-linux-gnu- \
#     qemu-aarch64-static -L build/arm64-root
#
# BUILD is a build of the preset `embedded`. Under an emulator, the memory is the
# emulator's and is left out. CFLAGS are for the compiler.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

build=${1:-build/embedded}
prefix=${2:-}
runner=("${@:3}")
model=server/registry/no-poses.tactus
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
read -r -a flags <<<"${CFLAGS:-}"

cat >"$work/model.s" <<END
.section .rodata
.globl model_begin, model_end
.balign 16
model_begin: .incbin "$model"
model_end: .byte 0
.section .note.GNU-stack,"",%progbits
END
compile() {
  "${prefix}gcc" "${flags[@]}" -std=c11 -O2 -Wall -Wextra -Werror -pedantic \
    -Iclient/c/include "$@"
}
bytes() { stat --format=%s "$1"; }
# sizes NAME FILE: of the file, and of its code and constants.
sizes() {
  local text
  "${prefix}strip" -o "$work/stripped" "$2"
  text=$("${prefix}size" "$work/stripped" | awk 'NR == 2 { print $1 }')
  printf '%-44s %9d bytes, %9d of them code and constants\n' "$1" \
    "$(bytes "$work/stripped")" "$text"
}

compile -o "$work/footprint" tests/client/c/footprint.c "$work/model.s" \
  -L"$build/lib" -ltactus_c
cp -a "$build"/lib/libtactus_c.so* "$work/"
"${prefix}strip" "$work/libtactus_c.so.1"
printf '%-44s %9d bytes\n' "$model" "$(bytes $model)"
sizes "libtactus_c.so.1, stripped" "$build/lib/libtactus_c.so.1"
sizes "the program with the model, stripped" "$work/footprint"
echo "libraries of the system that it names:"
"${prefix}readelf" --dynamic "$build/lib/libtactus_c.so.1" |
  sed -n 's/.*(NEEDED).*\[\(.*\)\].*/\1/p' | tr '\n' ' '
echo
if [[ ${#runner[@]} -gt 0 ]]; then
  "${runner[@]}" -E LD_LIBRARY_PATH="$work" "$work/footprint" >/dev/null
  echo "it runs under ${runner[0]}"
else
  LD_LIBRARY_PATH=$work "$work/footprint"
fi
