#!/usr/bin/env bash
# Builds the Dockerfile's image and proves that its tactusd serves, without a
# container engine and without an image registry:
#
#   1. a Debian 12 base made by mmdebstrap from this machine's own package
#      sources, committed under the name that the Dockerfile starts from;
#   2. the image, built by buildah from the Dockerfile as it stands;
#   3. tactusd run from it, as the image's user and with its entry point, on a
#      free loopback port: the image's own health check, then simulated contacts
#      streamed by tactus-stream, then SIGTERM and a clean exit;
#   4. the image's compressed size, under 150 MB.
#
#   deploy/check-image.sh        as root on Debian 12; takes a few minutes
#
# Installs buildah and mmdebstrap when they are missing, and builds
# tactus-stream when build/release/bin has none.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

readonly IMAGE=tactusd-check
readonly MAX_BYTES=$((150 * 1000 * 1000))
readonly TRIALS=16
readonly STREAM=build/release/bin/tactus-stream

say() { printf '\n== %s\n' "$*"; }
die() { printf 'check-image: %s\n' "$*" >&2; exit 1; }

if [[ $# -gt 0 ]]; then
  sed -n '2,/^set /{/^set /d;s/^# \{0,1\}//;p}' "$0"
  [[ $1 == -h || $1 == --help ]] && exit 0
  exit 2
fi
[[ $(id -u) -eq 0 ]] || die "must run as root (it makes a root file system)"

work=$(mktemp -d "${TMPDIR:-/var/tmp}/tactus-image.XXXXXX")
runner=""   # the 'buildah run' that we started
server=""   # the tactusd inside it

in_storage() {
  buildah --storage-driver vfs --root "$work/storage" \
    --runroot "$work/run" "$@"
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

clean_up() {
  local status=$? below=()
  if [[ -n $runner ]]; then
    mapfile -t below < <(descendants "$runner")
    kill -KILL "${below[@]}" "$runner" 2>/dev/null || true
    wait "$runner" 2>/dev/null || true
  fi
  in_storage rm --all >/dev/null 2>&1 || true
  rm -rf --one-file-system "$work"
  [[ $status -eq 0 ]] || echo "check-image: FAILED" >&2
}
trap clean_up EXIT

deploy/install-deps.sh --image
if [[ ! -x $STREAM ]]; then
  say "build tactus-stream, which the image has to serve"
  deploy/install-deps.sh
  cmake --preset release >"$work/configure.log" ||
    { cat "$work/configure.log" >&2; die "configuring failed"; }
  cmake --build --preset release --target tactus-stream
fi

say "base"
# This machine's sources for bookworm, and how its apt reaches them; where it
# has none, mmdebstrap's own defaults.
sources=()
for file in /etc/apt/sources.list /etc/apt/sources.list.d/*.{list,sources}; do
  if grep -Eqs '^[^#]*[[:space:]]bookworm([[:space:]]|$)' "$file"; then
    sources+=("$file")
  fi
done
apt-config dump | grep -E '^Acquire::(http|https|ftp|Check-|Retries)' \
  >"$work/apt.conf" || true
# What the slim base leaves out, this one leaves out.
slim=()
for dir in doc groff info linda lintian locale man; do
  slim+=("--dpkgopt=path-exclude=/usr/share/$dir/*")
done
mmdebstrap --quiet --variant=minbase --aptopt="$work/apt.conf" "${slim[@]}" \
  bookworm "$work/base.tar" "${sources[@]}"

base_name=$(awk 'toupper($1) == "FROM" { print $2; exit }' Dockerfile)
base=$(in_storage from scratch)
in_storage add --quiet "$base" "$work/base.tar" / >/dev/null
in_storage commit --quiet "$base" "$base_name" >/dev/null
in_storage rm "$base" >/dev/null
rm "$work/base.tar"
echo "$base_name"

say "image"
in_storage bud --isolation chroot --pull-never --format docker \
  --tag "$IMAGE" .

# config PATH: the image's configuration at a path, one element per line.
config() {
  in_storage inspect --type image \
    --format "{{range $1}}{{println .}}{{end}}" "$IMAGE" | sed '/^$/d'
}
user=$(in_storage inspect --type image --format '{{.OCIv1.Config.User}}' \
  "$IMAGE")
mapfile -t entry < <(config .OCIv1.Config.Entrypoint)
mapfile -t health < <(config .Docker.Config.Healthcheck.Test)
[[ -n $user && $user != 0* && $user != root* ]] ||
  die "the image runs as '${user:-root}'; it must name a user without rights"
[[ ${#entry[@]} -gt 0 ]] || die "the image has no ENTRYPOINT"
[[ ${health[0]-} == CMD ]] || die "the image has no HEALTHCHECK"

say "serve"
container=$(in_storage from --pull-never "$IMAGE")
root=$(in_storage mount "$container")
in_container() {
  in_storage run --isolation chroot "$container" -- "$@"
}

in_container "${entry[@]}" --listen=127.0.0.1:0 --port-file=/tmp/port &
runner=$!
for ((i = 0; i < 100; ++i)); do
  [[ ! -s $root/tmp/port ]] || break
  kill -0 "$runner" 2>/dev/null || die "tactusd ended before it served"
  sleep 0.1
done
[[ -s $root/tmp/port ]] || die "tactusd did not serve within 10 s"
port=$(<"$root/tmp/port")
for process in $(descendants "$runner"); do
  [[ $(readlink "/proc/$process/exe") != */tactusd ]] || server=$process
done
[[ -n $server ]] || die "no tactusd process below 'buildah run'"
uid=$(awk '$1 == "Uid:" { print $2 }' "/proc/$server/status")
[[ $uid -ne 0 ]] || die "tactusd runs as root"
echo "tactusd: process $server, user $uid, port $port"

in_container "${health[@]:1:${#health[@]}-2}" "${health[-1]/%:*/:$port}" ||
  die "the image's health check failed while tactusd served"
echo "health check: serving"

say "stream"
"$STREAM" --server="127.0.0.1:$port" --driver=sim --trials="$TRIALS" \
  --rate=max --json >"$work/stream.json" || {
  cat "$work/stream.json" >&2
  die "tactus-stream ended with an error"
}
cat "$work/stream.json"
number() { grep -Eo "\"$1\": *[0-9]+" "$work/stream.json" | grep -Eo '[0-9]+$'; }
[[ $(number trials) -eq $TRIALS ]] || die "not all $TRIALS contacts answered"
[[ $(number lost) -eq 0 ]] || die "frames were lost"

say "stop"
kill -TERM "$server"
for ((i = 0; i < 150; ++i)); do
  kill -0 "$server" 2>/dev/null || break
  sleep 0.1
done
! kill -0 "$server" 2>/dev/null || die "tactusd still there 15 s after SIGTERM"
wait "$runner" || die "tactusd ended with an error on SIGTERM"
runner=""
if in_container "${health[@]:1:${#health[@]}-2}" \
  "${health[-1]/%:*/:$port}" 2>/dev/null; then
  die "the health check still passes with no server"
fi
echo "tactusd drained and ended"

say "size"
in_storage push --quiet "$IMAGE" "oci-archive:$work/image.tar" >/dev/null
bytes=$(stat --format=%s "$work/image.tar")
awk -v b="$bytes" -v m="$MAX_BYTES" \
  'BEGIN { printf "%.1f MB compressed, limit %.0f MB\n", b / 1e6, m / 1e6 }'
[[ $bytes -lt $MAX_BYTES ]] || die "the image is too large"

say "the image builds, serves, stops and fits"
