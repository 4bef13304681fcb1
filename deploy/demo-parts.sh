#!/usr/bin/env bash
# What the demos share. They source it in the project's root and have a folder
# of their own, $work.

# build_programs DEMO TARGET...: installs and builds what is missing. What that
# prints is shown only if it fails.
build_programs() {
  local demo=$1
  shift
  echo "$demo: building (the first time takes minutes; tail -f" \
    "${work:?}/build.log)" >&2
  # A build folder that has the tests keeps them.
  local fresh=()
  [[ -e build/release/CMakeCache.txt ]] || fresh=(-D TACTUS_BUILD_TESTS=OFF)
  {
    deploy/install-deps.sh &&
      cmake --preset release "${fresh[@]}" &&
      cmake --build --preset release --parallel "$(nproc)" --target "$@"
  } >"$work/build.log" 2>&1 || {
    cat "$work/build.log" >&2
    echo "$demo: building failed" >&2
    exit 1
  }
}

# await_file DEMO FILE PID LOG: waits until the program PID has made FILE; ends
# with its log if it ends before.
await_file() {
  for ((i = 0; i < 300; ++i)); do
    [[ ! -s $2 && ! -S $2 ]] || return 0
    kill -0 "$3" 2>/dev/null || break
    sleep 0.1
  done
  cat "$4" >&2
  echo "$1: tactusd did not begin to serve" >&2
  exit 1
}

# stop_programs PID...: ends programs in good order and waits for them.
stop_programs() {
  local pid
  for pid in "$@"; do kill -TERM "$pid" 2>/dev/null || true; done
  for pid in "$@"; do wait "$pid" 2>/dev/null || true; done
}
