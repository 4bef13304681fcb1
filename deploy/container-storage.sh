# Sourced by deploy/check-image.sh and the scripts of tests/install: containers
# without an engine, in a storage of their own below $work.
# shellcheck shell=bash

say() { printf '\n== %s\n' "$*"; }
die() { printf '%s: %s\n' "${0##*/}" "$*" >&2; exit 1; }

# Open files of what runs in a container, as deploy/compose.yaml and the units
# say.
# shellcheck disable=SC2034
readonly FILES=nofile=16384:16384

# Before each command of buildah; enter_network puts it into a network.
enter=()
in_storage() {
  # shellcheck disable=SC2154
  "${enter[@]}" buildah --storage-driver vfs --root "$work/storage" \
    --runroot "$work/run" "$@"
}

# run_in CONTAINER [OPTIONS] -- COMMAND...: runs a command in a container.
run_in() {
  in_storage run --isolation chroot "$@"
}

# enter_network: from here on, containers have a network of their own, with a
# loopback address, in which all ports are free.
network=""
enter_network() {
  unshare --net --kill-child sleep infinity &
  network=$!
  enter=(nsenter "--net=/proc/$network/ns/net")
  until [[ $(readlink "/proc/$network/ns/net") != $(readlink /proc/self/ns/net) ]]
  do
    sleep 0.01
  done
  "${enter[@]}" ip link set lo up
}

# leave_network: ends that network; from here on, containers have the machine's.
leave_network() {
  [[ -z $network ]] || kill_below "$network"
  network=""
  enter=()
}

# descendants PID: the processes below PID, children of any of its threads.
descendants() {
  local child children=()
  read -r -d '' -a children < <(cat "/proc/$1"/task/*/children 2>/dev/null) ||
    true
  for child in "${children[@]}"; do
    echo "$child"
    descendants "$child"
  done
}

# kill_below PID...: ends PID and all processes below it.
kill_below() {
  local root below=()
  for root in "$@"; do
    mapfile -t below < <(descendants "$root")
    kill -KILL "${below[@]}" "$root" 2>/dev/null || true
    wait "$root" 2>/dev/null || true
  done
}

# program_below PID NAME: the process of the program NAME below PID.
program_below() {
  local process
  for process in $(descendants "$1"); do
    [[ $(readlink "/proc/$process/exe") != */"$2" ]] || echo "$process"
  done
}

# wait_for PID COMMAND...: until COMMAND succeeds; fails if PID ends before, or
# after 20 s.
wait_for() {
  local i
  for ((i = 0; i < 200; ++i)); do
    ! "${@:2}" >/dev/null 2>&1 || return 0
    kill -0 "$1" 2>/dev/null || return 1
    sleep 0.1
  done
  return 1
}

# exec_start FILE: the words of a unit's ExecStart, one per line.
exec_start() {
  sed -e ':a' -e '/\\$/{N;s/\\\n//;ba}' "$1" | sed -n 's/^ExecStart=//p' |
    xargs -n 1
}

# stream ADDRESS [COMMAND...]: streams simulated contacts, each of which must be
# answered, by a tactus-stream that COMMAND runs; without it, by this build's.
stream() {
  local trials=16 command=("${@:2}")
  [[ ${#command[@]} -gt 0 ]] ||
    command=("${enter[@]}" build/release/bin/tactus-stream)
  "${command[@]}" --server="$1" --driver=sim --trials="$trials" --rate=max \
    --json >"$work/stream.json" || {
    cat "$work/stream.json" >&2
    die "tactus-stream ended with an error"
  }
  cat "$work/stream.json"
  [[ $(number trials) -eq $trials ]] || die "not all $trials contacts answered"
  [[ $(number lost) -eq 0 ]] || die "frames were lost"
}
# number NAME: that of the whole stream, not of one class.
number() {
  /usr/bin/python3 -c 'import json, sys
print(json.load(open(sys.argv[1]))[sys.argv[2]])' "$work/stream.json" "$1"
}

# ask_console PATH COMMAND...: what the console on port 8080 answers, asked by a
# shell that COMMAND runs.
ask_console() {
  # shellcheck disable=SC2016  # the inner shell expands it
  "${@:2}" bash -euc 'exec 3<>/dev/tcp/127.0.0.1/8080
    printf "GET $1 HTTP/1.0\r\nHost: localhost\r\n\r\n" >&3; cat <&3' - "$1"
}

# make_base NAME: a Debian 12 base made by mmdebstrap from this machine's own
# package sources, as the image NAME.
make_base() {
  # This machine's sources for bookworm, and how its apt reaches them; where it
  # has none, mmdebstrap's own defaults.
  local sources=() slim=() file dir base
  for file in /etc/apt/sources.list /etc/apt/sources.list.d/*.{list,sources}; do
    if grep -Eqs '^[^#]*[[:space:]]bookworm([[:space:]]|$)' "$file"; then
      sources+=("$file")
    fi
  done
  apt-config dump | grep -E '^Acquire::(http|https|ftp|Check-|Retries)' \
    >"$work/apt.conf" || true
  # What the slim base leaves out, this one leaves out.
  for dir in doc groff info linda lintian locale man; do
    slim+=("--dpkgopt=path-exclude=/usr/share/$dir/*")
  done
  mmdebstrap --quiet --variant=minbase --aptopt="$work/apt.conf" "${slim[@]}" \
    bookworm "$work/base.tar" "${sources[@]}"
  base=$(in_storage from scratch)
  in_storage add --quiet "$base" "$work/base.tar" / >/dev/null
  in_storage commit --quiet "$base" "$1" >/dev/null
  in_storage rm "$base" >/dev/null
  rm "$work/base.tar"
}

# ccache_options: options of buildah that give a container this machine's ccache
# with what it keeps; none where there is no ccache. What ccache finds depends on
# the language too, which the container gets with it.
ccache_options() {
  local program
  program=$(command -v ccache) || return 0
  # shellcheck disable=SC2016
  printf '#!/bin/sh\n%s\nexec %s "$@"\n' \
    "$(export -p | sed -nE 's/^declare -x ((LANG|LC_[A-Z]+)=)/export \1/p')" \
    /opt/ccache >"$work/ccache"
  chmod 755 "$work/ccache"
  printf -- '--volume\n%s:/root/.cache/ccache\n' \
    "$(ccache --get-config cache_dir)"
  printf -- '--volume\n%s:/usr/local/bin/ccache:ro\n' "$work/ccache"
  printf -- '--volume\n%s:/opt/ccache:ro\n' "$program"
  ldd "$program" | grep -Eo '/[^ ]*/libhiredis[^ ]*' |
    while read -r library; do
      printf -- '--volume\n%s:%s:ro\n' "$library" "$library"
    done
}
