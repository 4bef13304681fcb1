#!/usr/bin/env bash
# Tries every way to install that a page names, each from a minimal root of
# Debian 12 (deploy/container-storage.sh), which all share:
#
#   1. the images: deploy/check-image.sh, which builds with the packages of
#      `install-deps.sh --build` and runs with those of --runtime;
#   2. docs/your-first-client.md: `cmake --install` of that build, the example
#      built against it and run against tactusd;
#   3. deploy/tactusd.service and deploy/tactus-console.service: their commands
#      in a root with the packages of --runtime and --proxy; the units checked by
#      systemd-analyze, their programs started as they say, contacts streamed
#      through the proxy, the console asked. The page is that of build/release.
#
#   tests/install/run.sh         as root; six to nine minutes
#
# Exits with 77 if it is not run by root, or where root may not mount.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
# shellcheck source=deploy/container-storage.sh
. deploy/container-storage.sh

if [[ $(id -u) -ne 0 ]]; then
  echo "install: skipped: only root can make root file systems"
  exit 77
fi
if ! unshare --mount --net mount -t tmpfs none /mnt; then
  echo "install: skipped: root may make no namespaces and mounts here"
  exit 77
fi
work=$(mktemp -d "${TMPDIR:-/var/tmp}/tactus-install.XXXXXX")
runners=()
clean_up() {
  local status=$?
  kill_below "${runners[@]}"
  leave_network
  in_storage rm --all >/dev/null 2>&1 || true
  rm -rf --one-file-system "$work"
  [[ $status -eq 0 ]] || echo "install: FAILED" >&2
}
trap clean_up EXIT

deploy/check-image.sh --keep="$work"
base=$(awk 'toupper($1) == "FROM" { print $2; exit }' Dockerfile)

# What the Dockerfile built, in a root like that in which it was built.
say "cmake --install, and a client built against it"
build=$(in_storage from --pull-never "$base")
mapfile -t options < <(ccache_options)
in_build() {
  run_in "${options[@]}" --volume "$PWD:$PWD:ro" \
    --volume "$work/build:$PWD/build" "$build" -- "$@"
}
built=$PWD/build/release
in_build "$PWD/deploy/install-deps.sh" --build
in_build cmake --build "$built" --target tactus_component_client
for component in base client; do
  in_build cmake --install "$built" --component "$component" \
    --prefix /usr/local >/dev/null
done
in_build cmake -G Ninja -S "$PWD/examples/first_client" -B /tmp/first_client \
  >/dev/null
in_build cmake --build /tmp/first_client
enter_network
in_build "$built/bin/tactusd" --listen=127.0.0.1:50051 --log-level=warn &
runners+=("$!")
wait_for "$!" in_build "$built/bin/tactusd" --health-check=127.0.0.1:50051 ||
  die "the tactusd that was built does not serve"
in_build sh -c '/tmp/first_client/first_client 127.0.0.1:50051 >/tmp/client.txt'
answer=$(in_storage mount "$build")/tmp/client.txt
cat "$answer"
[[ $(grep -cE '^(hardness|mobility): [a-z]+ [01]\.[0-9]*$' "$answer") -eq 4 ]] ||
  die "the client prints no four probabilities"
kill_below "${runners[@]}"
runners=()
leave_network

# The commands at the head of tactusd.service, without those that need a system
# that runs systemd.
say "the systemd units"
unit=$(in_storage from --pull-never --ulimit "$FILES" "$base")
unit_root=$(in_storage mount "$unit")
install -d "$unit_root/project/build/release/bin"
cp -r deploy "$unit_root/project/"
cp "$work"/build/release/bin/{tactusd,tactus-trainer,trainctl,tactus-console} \
  "$unit_root/project/build/release/bin/"
cp -r build/release/share "$unit_root/project/build/release/" ||
  die "the page is not built: cmake --build --preset release --target console_page"
in_unit() { run_in "$unit" -- "$@"; }
sed -n 's/^#   //p' deploy/tactusd.service deploy/tactus-console.service | grep -E '^(deploy/|install )' \
  >"$unit_root/project/commands"
cat "$unit_root/project/commands"
in_unit bash -euc 'cd /project && . ./commands'
in_unit apt-get -qq install --yes --no-install-recommends systemd >/dev/null
for service in tactusd tactusd-proxy tactus-console; do
  in_unit systemd-analyze verify --man=no \
    "/etc/systemd/system/$service.service"
done

words_of() { exec_start "$unit_root/etc/systemd/system/$1.service"; }
# As the units' StateDirectory= and RuntimeDirectory=, and a user without rights.
install -d -o 10001 -g 10001 -m 700 "$unit_root"/{var/lib,run}/tactus
as_user() { run_in --user 10001:10001 "$unit" -- "$@"; }
enter_network
mapfile -t words < <(words_of tactusd)
as_user "${words[@]}" &
runners+=("$!")
wait_for "$!" as_user tactusd --health-check=127.0.0.1:50052 ||
  die "the unit's tactusd does not serve"
# Without -Ws, which reports to systemd.
mapfile -t words < <(words_of tactusd-proxy | grep -vx -- -Ws)
as_user env TACTUS_BIND=127.0.0.1 "${words[@]}" &
runners+=("$!")
wait_for "$!" as_user tactusd --health-check=127.0.0.1:50051 ||
  die "the unit's proxy does not serve"
stream 127.0.0.1:50051
as_user trainctl models list --server=unix:/run/tactus/tactusd.sock
! as_user trainctl models list --server=127.0.0.1:50051 ||
  die "a stranger may list models through the proxy"

mapfile -t words < <(words_of tactus-console)
as_user "${words[@]}" &
runners+=("$!")
wait_for "$!" ask_console / as_user || die "the unit's console does not serve"
[[ $(ask_console / as_user) == *"<title>Tactus"* ]] || die "the console has no page"
# The server behind a proxy has no tokens yet, and shows robots to no stranger.
[[ $(ask_console /api/session as_user) == *'"signed_in":false'* ]] ||
  die "the unit's console lets a stranger watch"

say "every way to install works"
