#!/usr/bin/env bash
# libtactus_c for 64-bit ARM (Jetson, Raspberry Pi), compiled on another machine,
# and tried there: docs/arm64.md.
#
#   deploy/arm64.sh           builds and installs it to build/arm64-install
#   deploy/arm64.sh --test    and runs the tests of what it consists of under
#                             QEMU, and compares its answers about 64 contacts
#                             with those of this machine
#
# Debian's libraries for arm64 come into a root of their own (build/arm64-root),
# so this machine's packages stay as they are, but for the cross compiler and
# QEMU (install-deps.sh --arm64). --test needs build/release/bin/trainctl.
#
# Exits with 77 where that root cannot be made.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

test=no
for arg in "$@"; do
  case "$arg" in
    --test) test=yes ;;
    -h | --help) sed -n '2,/^set /{/^set /d;s/^# \{0,1\}//;p}' "$0"; exit 0 ;;
    *) echo "arm64.sh: unknown option '$arg' (try --help)" >&2; exit 2 ;;
  esac
done
say() { printf '\n== %s\n' "$*"; }
die() { echo "arm64.sh: $*" >&2; exit 1; }

# What is linked, and what the tests link besides.
readonly LIBRARIES=(
  libabsl-dev
  libc6-dev
  libeigen3-dev
  libgmock-dev
  libgtest-dev
  libhwy-dev
  libisal-dev
  libopencv-core-dev
  libopencv-imgproc-dev
  libprotobuf-dev
  libssl-dev
  libstdc++-12-dev
  nlohmann-json3-dev
)
root=$PWD/build/arm64-root
build=build/arm64
emulator=(qemu-aarch64-static -L "$root")

deploy/install-deps.sh --arm64
if [[ ! -e $root/complete ]]; then
  say "libraries for arm64"
  rm -rf --one-file-system "$root"
  mkdir -p build
  if ! mmdebstrap --quiet --variant=extract --architectures=arm64 \
    --include="$(IFS=,; echo "${LIBRARIES[*]}")" bookworm "$root"; then
    echo "arm64.sh: skipped: no root of Debian for arm64 can be made here"
    exit 77
  fi
  # Only their scripts, which an extracted root does not run, would link them.
  for library in blas/libblas.so.3 lapack/liblapack.so.3; do
    ln -s "$library" "$root/usr/lib/aarch64-linux-gnu/"
  done
  touch "$root/complete"
fi

say "build"
cmake --preset embedded -B "$build" --toolchain cmake/arm64.cmake \
  -D TACTUS_ARM64_ROOT="$root" >/dev/null
targets=(tactus_c)
[[ $test == no ]] || targets=(all)
cmake --build "$build" --parallel "$(nproc)" --target "${targets[@]}"
cmake --install "$build" --component c --prefix build/arm64-install >/dev/null
file=$(find build/arm64-install -name 'libtactus_c.so.1.*')
aarch64-linux-gnu-readelf --file-header "$file" | grep -q AArch64 ||
  die "$file is not for arm64"
CFLAGS=--sysroot=$root docs/measure-c.sh "$build" aarch64-linux-gnu- "${emulator[@]}"
[[ $test == yes ]] || exit 0

say "instruction sets of Highway"
cmake --preset embedded >/dev/null
cmake --build --preset embedded --target c_answers instruction_sets >/dev/null
printf 'here:  %s\n' "$(build/embedded/tests/instruction_sets)"
sets=$("${emulator[@]}" "$build/tests/instruction_sets")
printf 'arm64: %s\n' "$sets"
[[ $sets == NEON* ]] || die "the kernels do not run on NEON"

say "tests under QEMU"
ctest --test-dir "$build" --output-on-failure --parallel 2 \
  --label-exclude '^long$'

say "answers here and there"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
build/release/bin/trainctl simulate --protocol=random --contacts=64 --skin=good \
  --seed=3 --out="$work/contacts.h5" >/dev/null
/usr/bin/python3 -B tests/client/c/frames_of_trials.py "$work/contacts.h5" \
  "$work/frames"
# compare MODEL POSES
compare() {
  local arguments=("server/registry/$1.tactus" "$work/frames" "$2")
  build/embedded/tests/c_answers "${arguments[@]}" >"$work/here"
  "${emulator[@]}" "$build/tests/c_answers" "${arguments[@]}" >"$work/there"
  printf '%s: ' "$1"
  python3 -B tests/client/c/compare_answers.py "$work/here" "$work/there" 1e-12
}
compare default 1
compare no-poses 0
