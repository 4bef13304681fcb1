#!/usr/bin/env bash
# The example in C, as docs/c.md shows it: builds libtactus_c, installs it, and
# builds the example with CMake and with pkg-config. The library exports the
# functions of tactus.h and no others, and needs no gRPC, HDF5 or OpenCV.
#
#   tests/examples/in_process_c_test.sh BUILD_DIR
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

work=$1/in_process_c
rm -rf "$work"
mkdir -p "$work"
fail() { echo "in_process_c_test: $1" >&2; exit 1; }

cmake --preset embedded >/dev/null
cmake --build --preset embedded --target tactus_c >"$work/build.log" ||
  { cat "$work/build.log" >&2; fail "libtactus_c does not compile"; }
cmake --install build/embedded --component c --prefix "$work/prefix" >/dev/null

library=$(find "$work/prefix" -name libtactus_c.so.1)
declared=$(sed -nE 's/^TACTUS_API .*\<(tactus_[a-z0-9_]+)\(.*/\1/p' \
  "$work/prefix/include/tactus.h" | sort)
# The names that stand alone in the line after their type.
declared+=$'\n'$(sed -nE 's/^TACTUS_API .* (tactus_[a-z0-9_]+)\($/\1/p' \
  "$work/prefix/include/tactus.h")
diff <(sort -u <<<"$declared") \
  <(nm --dynamic --defined-only "$library" | sed -n 's/.* T //p; s/@.*//' |
    sed 's/@.*//' | sort -u) || fail "it exports other names than the header"
! ldd "$library" | grep -E 'grpc|hdf5|opencv|libtactus' ||
  fail "it needs what a small machine does not have"

cmake -S examples/in_process_c -B "$work/build" -G Ninja \
  -DCMAKE_PREFIX_PATH="$work/prefix" >/dev/null
cmake --build "$work/build" >/dev/null
"$work/build/in_process_c" server/registry/no-poses.tactus >"$work/cmake.txt"

pkgconfig=$(dirname "$(find "$work/prefix" -name tactus_c.pc)")
read -r -a flags < <(PKG_CONFIG_PATH=$pkgconfig pkg-config --cflags --libs tactus_c)
cc -std=c11 -Wall -Wextra -Werror -pedantic -o "$work/by_hand" \
  examples/in_process_c/in_process_c.c "${flags[@]}"
LD_LIBRARY_PATH=$(dirname "$library") "$work/by_hand" \
  server/registry/no-poses.tactus >"$work/by_hand.txt"

cat "$work/cmake.txt"
diff "$work/cmake.txt" "$work/by_hand.txt"
for event in 'contact 1 touched' 'contact 1 decided hardness: ' \
  'contact 1 released'; do
  grep -q " ms: $event" "$work/cmake.txt" || fail "nothing says: $event"
done
[[ $(grep -cE '^[A-Z]{2} [0-9.e-]+$' "$work/cmake.txt") -eq 4 ]] ||
  fail "there are not four classes"
! "$work/build/in_process_c" /none.tactus 2>"$work/error.txt" ||
  fail "there is a model where no file is"
grep -q '^IO: .*/none.tactus' "$work/error.txt" || fail "the error is not clear"
