#!/usr/bin/env bash
# Builds Tactus and runs its tests; on a fresh Debian 12 this is all it takes.
#
#   tests/run.sh               installs what is missing, checks format and scripts,
#                              builds the release preset, runs the quick tests
#   tests/run.sh --full        the long tests and research/ too, trains the
#                              default bundle again, classifies and trains in
#                              Python without a server, executes the notebook, the
#                              C interface on 64-bit ARM under QEMU, and --install
#   tests/run.sh --sanitize    the quick tests under the asan and tsan presets
#                              too (tsan: those of code that has threads)
#   tests/run.sh --install     every way to install, from minimal roots
#                              (tests/install)
#   tests/run.sh --vm          the CAN and USB drivers on a real kernel too, in
#                              a guest of QEMU (tests/vm/run.sh)
#
# Stops at the first step that fails. The last lines say what took how long.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

full=no
sanitize=no
install=no
vm=no
for arg in "$@"; do
  case "$arg" in
    --full) full=yes install=yes ;;
    --sanitize) sanitize=yes ;;
    --install) install=yes ;;
    --vm) vm=yes ;;
    -h | --help) sed -n '2,/^set /{/^set /d;s/^# \{0,1\}//;p}' "$0"; exit 0 ;;
    *) echo "run.sh: unknown option '$arg' (try --help)" >&2; exit 2 ;;
  esac
done

summary=()
current=""

# step NAME COMMAND...: runs one command, with a headline and a stopwatch.
step() {
  current=$1
  local begin=$SECONDS
  printf '\n== %s\n' "$current"
  "${@:2}"
  summary+=("$(printf '%5d s  %s' $((SECONDS - begin)) "$current")")
  current=""
}

report() {
  local status=$?
  printf '\n'
  [[ ${#summary[@]} -eq 0 ]] || printf '%s\n' "${summary[@]}"
  if [[ $status -eq 0 && -z $current ]]; then
    printf '%5d s  all passed\n' "$SECONDS"
  else
    printf 'FAILED: %s\n' "${current:-setup}"
  fi
}
trap report EXIT

check_scripts() {
  find . -path ./build -prune -o -name '*.sh' -print0 |
    xargs -0 shellcheck --external-sources .ci/run
}

check_format() {
  find core server client tools tests research examples \
    \( -name '*.cc' -o -name '*.h' -o -name '*.c' \) -print0 |
    xargs -0 -r clang-format --dry-run -Werror
}

# The sanitizers lose their way when the kernel randomises addresses by more than
# 28 bits; there they run without randomisation.
plain_addresses=()
rnd_bits=$(cat /proc/sys/vm/mmap_rnd_bits 2>/dev/null || echo 0)
if [[ $rnd_bits -gt 28 ]] && setarch "$(uname -m)" -R true 2>/dev/null; then
  plain_addresses=(setarch "$(uname -m)" -R)
fi

# build_and_test PRESET [CTEST OPTIONS]: configures, builds and tests it.
build_and_test() {
  local preset=$1
  shift
  local wrap=()
  [[ $preset == release ]] || wrap=("${plain_addresses[@]}")
  step "$preset: configure" cmake --preset "$preset" -D TACTUS_RESEARCH="$research"
  step "$preset: build" "${wrap[@]}" \
    cmake --build --preset "$preset" --parallel "$(nproc)"
  step "$preset: test" "${wrap[@]}" \
    ctest --preset "$preset" --parallel 2 --no-tests=error --timeout 600 "$@"
}

# The studies and their tests are a part of the long run.
research=OFF
[[ $full == no ]] || research=ON
quick=(--label-exclude '^long$')
release_tests=("${quick[@]}")
[[ $full == no ]] || release_tests=()

step "packages" deploy/install-deps.sh --tests
step "format" check_format
step "scripts" check_scripts
build_and_test release "${release_tests[@]}"
if [[ $full == yes ]]; then
  step "default bundle comes out again" deploy/train-default-bundle.sh --check
  step "python: build and test" env TACTUS_PYTHON_NATIVE=yes \
    client/python/tests/run.sh build/release/bin classifier_test docs_test \
    estimator_test notebook_test
fi
# 77: it has said what it lacks.
unless_lacking() { "$@" || [[ $? -eq 77 ]]; }
if [[ $full == yes ]]; then
  step "64-bit ARM" unless_lacking deploy/arm64.sh --test
fi
if [[ $install == yes ]]; then
  step "image and other installations" unless_lacking tests/install/run.sh
  step "Debian packages" unless_lacking tests/install/packages.sh
fi
if [[ $vm == yes ]]; then
  step "guest" unless_lacking tests/vm/run.sh --build=build/release
fi
if [[ $sanitize == yes ]]; then
  export ASAN_OPTIONS=detect_stack_use_after_return=1:strict_string_checks=1
  export UBSAN_OPTIONS=print_stacktrace=1
  export TSAN_OPTIONS=halt_on_error=1:second_deadlock_stack=1
  build_and_test asan "${quick[@]}"
  build_and_test tsan "${quick[@]}"
fi
