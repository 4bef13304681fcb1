#!/usr/bin/env bash
# Builds the Dockerfile's images and proves that they serve, without a container
# engine and without an image registry:
#
#   1. a Debian 12 base made by mmdebstrap from this machine's own package
#      sources, committed under the name that the Dockerfile starts from;
#   2. the images of tactusd and of the proxy, built by buildah from the
#      Dockerfile as it stands; objects that ccache has are not compiled again;
#   3. both run as deploy/compose.yaml says, as the images' users: the image's
#      own health check, then simulated contacts streamed by tactus-stream
#      through the proxy, trainctl, the console asked through the proxy, then
#      SIGTERM and a clean exit;
#   4. the image's compressed size, under 150 MB.
#
#   deploy/check-image.sh                  as root on Debian 12
#   deploy/check-image.sh --keep=FOLDER    leaves buildah's storage and what
#                                          was built in FOLDER, for
#                                          tests/install/run.sh
#
# Installs buildah and mmdebstrap when they are missing, and builds
# tactus-stream when build/release/bin has none.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=deploy/container-storage.sh
. deploy/container-storage.sh

readonly IMAGE=tactusd-check
readonly PROXY=tactusd-proxy-check
readonly MAX_BYTES=$((150 * 1000 * 1000))
readonly STREAM=build/release/bin/tactus-stream

keep=""
for arg in "$@"; do
  case "$arg" in
    --keep=*) keep=${arg#--keep=} ;;
    -h | --help) sed -n '2,/^set /{/^set /d;s/^# \{0,1\}//;p}' "$0"; exit 0 ;;
    *) echo "check-image: unknown option '$arg' (try --help)" >&2; exit 2 ;;
  esac
done
[[ $(id -u) -eq 0 ]] || die "must run as root (it makes a root file system)"

work=${keep:-$(mktemp -d "${TMPDIR:-/var/tmp}/tactus-image.XXXXXX")}
server_runner=""   # the 'buildah run' of tactusd
proxy_runner=""    # that of HAProxy
console_runner=""  # that of tactus-console

clean_up() {
  local status=$?
  [[ -z $proxy_runner ]] || kill_below "$proxy_runner"
  [[ -z $server_runner ]] || kill_below "$server_runner"
  [[ -z $console_runner ]] || kill_below "$console_runner"
  leave_network
  if [[ -z $keep ]]; then
    in_storage rm --all >/dev/null 2>&1 || true
    rm -rf --one-file-system "$work"
  fi
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

base_name=$(awk 'toupper($1) == "FROM" { print $2; exit }' Dockerfile)
say "base: $base_name"
make_base "$base_name"

# The sources lie where they lie here, and warnings are errors as in the presets,
# so that ccache finds what the release preset has compiled. What is built stays
# in $work/build.
install -d "$work/build"
options=(--build-arg SOURCE="$PWD"
  --build-arg CMAKE_OPTIONS=-DTACTUS_WERROR=ON
  --volume "$work/build:$PWD/build")
mapfile -t -O "${#options[@]}" options < <(ccache_options)
# npm trusts whom this machine trusts beside the usual authorities.
own=/usr/local/share/ca-certificates
[[ ! -d $own ]] || options+=(--volume "$own:$own:ro")
# build_image TARGET NAME
build_image() {
  in_storage bud --isolation chroot --pull-never --format docker \
    "${options[@]}" --tag "$2" --target "$1" .
}
say "image of the proxy"
build_image proxy "$PROXY"
say "image"
build_image tactusd "$IMAGE"

# config PATH: the image's configuration at a path, one element per line.
config() {
  in_storage inspect --type image \
    --format "{{range $1}}{{println .}}{{end}}" "$IMAGE" | sed '/^$/d'
}
mapfile -t entry < <(config .OCIv1.Config.Entrypoint)
mapfile -t health < <(config .Docker.Config.Healthcheck.Test)
[[ ${#entry[@]} -gt 0 ]] || die "the image has no ENTRYPOINT"
[[ ${health[0]-} == CMD ]] || die "the image has no HEALTHCHECK"
for image in "$IMAGE" "$PROXY"; do
  user=$(in_storage inspect --type image --format '{{.OCIv1.Config.User}}' \
    "$image")
  [[ -n $user && $user != 0* && $user != root* ]] ||
    die "$image runs as '${user:-root}'; it must name a user without rights"
done

say "serve, as deploy/compose.yaml says"
# compose SERVICE EXPRESSION: words of a service in compose.yaml.
compose() {
  /usr/bin/python3 -c "import sys, yaml
service = yaml.safe_load(open('deploy/compose.yaml'))['services']['$1']
print('\n'.join($2))"
}
mapfile -t command < <(compose tactusd "service['command']")
mapfile -t probe < <(compose tactusd "service['healthcheck']['test'][1:]")
mapfile -t proxy_command < <(compose proxy "service['command']")
mapfile -t console_command < <(
  compose console "service['entrypoint'] + service['command']")
for service in tactusd console; do
  [[ $(compose "$service" "[service['network_mode']]") == service:proxy ]] ||
    die "$service is not in the proxy's network"
done
[[ $(compose tactusd "service['volumes']") == *data:/data* ]] ||
  die "compose.yaml keeps /data in no named volume"
enter_network
proxy=$(in_storage from --pull-never --ulimit "$FILES" "$PROXY")
container=$(in_storage from --pull-never --ulimit "$FILES" "$IMAGE")
root=$(in_storage mount "$container")
# Its tmpfs.
install -d -o 10001 -g 10001 -m 700 "$root/run/tactus"

run_in "$proxy" -- haproxy -f /etc/haproxy/haproxy.cfg "${proxy_command[@]}" &
proxy_runner=$!
run_in "$container" -- "${entry[@]}" "${command[@]}" &
server_runner=$!
wait_for "$server_runner" run_in "$container" -- "${probe[@]}" ||
  die "tactusd did not serve within 20 s"
server=$(program_below "$server_runner" tactusd)
[[ -n $server ]] || die "no tactusd process below 'buildah run'"
uid=$(awk '$1 == "Uid:" { print $2 }' "/proc/$server/status")
[[ $uid -ne 0 ]] || die "tactusd runs as root"
echo "tactusd: process $server, user $uid"
wait_for "$proxy_runner" run_in "$container" -- "${health[@]:1}" ||
  die "the image's health check failed through the proxy"
echo "health check: serving"

say "stream through the proxy"
stream 127.0.0.1:50051

say "trainctl in the container"
trainctl() { run_in "$container" -- trainctl "$@"; }
admin=unix:/run/tactus/tactusd.sock
trainctl datasets create arm --server="$admin"
trainctl simulate --protocol=random --contacts=4 --skin=good --seed=3 \
  --out=/data/sim.h5
trainctl datasets upload arm --data=/data/sim.h5 --server="$admin"
trainctl doctor --server="$admin" || [[ $? -eq 1 ]]
! trainctl datasets list --server=127.0.0.1:50051 2>"$work/refused" ||
  die "a stranger may list datasets through the proxy"
grep -q UNAUTHENTICATED "$work/refused" || die "refused without UNAUTHENTICATED"

say "the console, through the proxy"
run_in "$container" -- "${console_command[@]}" &
console_runner=$!
ask() { ask_console "$1" run_in "$container" --; }
has_page() { [[ $(ask /) == *"<title>Tactus"* ]]; }
wait_for "$console_runner" has_page || die "the console has no page"
[[ $(ask /api/session) == *'"signed_in":false'* ]] ||
  die "the console lets a stranger watch"
kill_below "$console_runner"
console_runner=""

say "stop"
kill -TERM "$server"
for ((i = 0; i < 150; ++i)); do
  kill -0 "$server" 2>/dev/null || break
  sleep 0.1
done
! kill -0 "$server" 2>/dev/null || die "tactusd still there 15 s after SIGTERM"
wait "$server_runner" || die "tactusd ended with an error on SIGTERM"
server_runner=""
if run_in "$container" -- "${health[@]:1}" 2>/dev/null; then
  die "the health check still passes with no server"
fi
trainctl doctor --data-dir=/data
echo "tactusd drained and ended"

say "size"
for image in "$PROXY" "$IMAGE"; do
  in_storage push --quiet "$image" "oci-archive:$work/image.tar" >/dev/null
  bytes=$(stat --format=%s "$work/image.tar")
  rm "$work/image.tar"
  awk -v n="$image" -v b="$bytes" -v m="$MAX_BYTES" 'BEGIN {
    printf "%s: %.1f MB compressed, limit %.0f MB\n", n, b / 1e6, m / 1e6 }'
  [[ $bytes -lt $MAX_BYTES ]] || die "the image is too large"
done

say "the images build, serve, stop and fit"
