#!/usr/bin/env bash
# The life of the Debian packages in minimal roots of Debian 12:
#
#   1. deploy/packages.sh builds them, and lintian finds no error;
#   2. libtactus-dev, where nothing else is: the examples are built against it;
#   3. tactus-ros2 and python3-tactus, each where nothing else is: they need no
#      more than they name;
#   4. all but libtactus-dev are installed; what their units say is started,
#      contacts streamed through the proxy, trials stored. What Python answers
#      without a server are the server's answers, bit for bit;
#   5. a newer version comes, the packages are removed, and installed again:
#      each time the trials are still served;
#   6. the packages are purged, without a question: nothing is left.
#
#   tests/install/packages.sh    as root; six to ten minutes after a build
#
# Exits with 77 if it is not run by root, or where root may not mount.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
# shellcheck source=deploy/container-storage.sh
. deploy/container-storage.sh

if [[ $(id -u) -ne 0 ]]; then
  echo "packages: skipped: only root can make root file systems"
  exit 77
fi
if ! unshare --mount --net mount -t tmpfs none /mnt; then
  echo "packages: skipped: root may make no namespaces and mounts here"
  exit 77
fi
work=$(mktemp -d "${TMPDIR:-/var/tmp}/tactus-packages.XXXXXX")
runners=()
clean_up() {
  local status=$?
  kill_below "${runners[@]}"
  leave_network
  in_storage rm --all >/dev/null 2>&1 || true
  rm -rf --one-file-system "$work"
  [[ $status -eq 0 ]] || echo "packages: FAILED" >&2
}
trap clean_up EXIT
# done_step TEXT: one line for each step that passed.
done_step() { printf 'ok: %s\n' "$*"; }

deploy/install-deps.sh --image
say "packages"
deploy/packages.sh >"$work/build.log" 2>&1 ||
  { cat "$work/build.log" >&2; die "deploy/packages.sh failed"; }
sed -n '/^== lintian/,$p' "$work/build.log"
done_step "built, no errors of lintian"
newer=9.$(dpkg-deb --field dist/tactus-server_*.deb Version)
deploy/packages.sh --version="$newer" --out="$work/newer" \
  >"$work/build.log" 2>&1 ||
  { cat "$work/build.log" >&2; die "no version $newer"; }
done_step "built as version $newer"

say "roots of Debian 12"
make_base tactus-packages-base
# new_root: a container with the packages in /packages and /newer.
new_root() {
  local container
  container=$(
    in_storage from --pull-never --ulimit "$FILES" tactus-packages-base)
  cp -r dist "$(in_storage mount "$container")/packages"
  cp -r "$work/newer" "$(in_storage mount "$container")/newer"
  run_in "$container" -- apt-get -qq update
  echo "$container"
}
# quietly COMMAND...: shows what it says only if it fails. It has no input, so a
# question would end it.
quietly() {
  "$@" </dev/null >"$work/quiet.log" 2>&1 ||
    { cat "$work/quiet.log" >&2; die "failed: $*"; }
}
install_with() {
  quietly "$1" apt-get -qq install --yes --no-install-recommends "${@:2}"
}

dev=$(new_root)
in_dev() { run_in --volume "$PWD/examples:/examples:ro" "$dev" -- "$@"; }
install_with in_dev cmake g++ ninja-build \
  "/packages/$(cd dist && echo libtactus-dev_*.deb)"
for example in first_client in_process own_driver; do
  quietly in_dev cmake -G Ninja -S "/examples/$example" -B "/tmp/$example"
  quietly in_dev cmake --build "/tmp/$example"
  done_step "examples/$example builds against libtactus-dev"
done

robot=$(new_root)
in_robot() {
  run_in --volume "$PWD/server/registry:/registry:ro" \
    --volume "$PWD/tests/install:/tests:ro" "$robot" -- "$@"
}
install_with in_robot "/packages/$(cd dist && echo tactus-ros2_*.deb)"
quietly in_robot tactus-ros2 --help
release=$(in_robot tactus-ros2 --version)
release=${release#* }
diff -r client/ros2/tactus_msgs \
  "$(in_storage mount "$robot")/usr/share/tactus/ros2/tactus_msgs" ||
  die "tactus-ros2 has other messages"
quietly in_robot apt-get -qq purge --yes --auto-remove tactus-ros2
done_step "tactus-ros2 runs alone, and has the messages"
install_with in_robot "/packages/$(cd dist && echo python3-tactus_*.deb)"
[[ $(in_robot python3 -c 'import importlib.metadata as metadata, tactus
tactus.Client, tactus.Classifier("/registry/default.tactus")
print(metadata.version("tactus"))') == "$release" ]] ||
  die "Python finds no tactus $release"
done_step "python3-tactus runs alone: a client, and a classifier"
# What it recommends reads recordings.
install_with in_robot python3-h5py

server=$(new_root)
root=$(in_storage mount "$server")
in_server() { run_in "$server" -- "$@"; }
install_with in_server systemd
ours=(tactus-server tactus-tools tactus-console tactus-ros2 python3-tactus)
# packages_in FOLDER: the files of these.
packages_in() {
  local package
  for package in "${ours[@]}"; do
    echo "/$1/$(cd "$root/$1" && echo "${package}"_*.deb)"
  done
}
mapfile -t old < <(packages_in packages)
mapfile -t new < <(packages_in newer)
install_with in_server "${old[@]}"

id_of() { awk -F: -v name=tactus '$1 == name { print $3 }' "$root/etc/$1"; }
user=$(id_of passwd)
[[ -n $user && $user -lt 1000 ]] || die "no system user tactus"
[[ $(stat --format='%u %a' "$root/var/lib/tactus") == "$user 700" ]] ||
  die "/var/lib/tactus is not that of the user alone"
units=(tactusd tactusd-proxy tactus-console)
wanted=$root/etc/systemd/system/multi-user.target.wants
grep -qx User=tactus "$root/lib/systemd/system/tactusd.service" ||
  die "tactusd is not the user tactus"
for unit in "${units[@]}"; do
  [[ -L $wanted/$unit.service ]] || die "$unit is not enabled"
  in_server systemd-analyze verify --man=no "/lib/systemd/system/$unit.service"
done
for program in tactusd tactus-worker trainctl tactus-stream tactus-load \
  tactus-fakeskin tactus-console tactus-ros2; do
  quietly in_server "$program" --help
done
done_step "installed: a user with a folder, three enabled units, all programs run"

enter_network
as() { run_in --user "$1" "$server" -- "${@:2}"; }
words_of() { exec_start "$root/lib/systemd/system/$1.service"; }
admin=(--server=unix:/run/tactus/tactusd.sock)
# start_server: what tactusd.service starts, in the folders that it names.
start_server() {
  install -d -o "$user" -g "$(id_of group)" -m 700 "$root/run/tactus"
  mapfile -t words < <(words_of tactusd)
  as tactus "${words[@]}" &
  runners+=("$!")
  wait_for "$!" as tactus tactusd --health-check=127.0.0.1:50052 ||
    die "the unit's tactusd does not serve"
}
stop_all() {
  kill_below "${runners[@]}"
  runners=()
}
datasets() { in_server trainctl datasets list "${admin[@]}" --json; }

start_server
# Without -Ws, which reports to systemd.
mapfile -t words < <(words_of tactusd-proxy | grep -vx -- -Ws)
as nobody env TACTUS_BIND=127.0.0.1 "${words[@]}" &
runners+=("$!")
wait_for "$!" as nobody tactusd --health-check=127.0.0.1:50051 ||
  die "the unit's proxy does not serve"
stream 127.0.0.1:50051 as nobody tactus-stream
done_step "streamed through the proxy: every contact answered"
in_dev sh -c '/tmp/first_client/first_client 127.0.0.1:50051 >/tmp/client.txt'
answer=$(in_storage mount "$dev")/tmp/client.txt
[[ $(grep -cE '^(hardness|mobility): [a-z]+ [01]\.[0-9]*$' "$answer") -eq 4 ]] ||
  die "the client prints no four probabilities"
done_step "a client built against libtactus-dev is answered"

quietly in_server trainctl simulate --protocol=random --contacts=64 --skin=good \
  --seed=12 --out=/tmp/contacts.h5
cp "$root/tmp/contacts.h5" "$(in_storage mount "$robot")/tmp"
in_robot python3 /tests/python_answers.py 127.0.0.1:50051 /tmp/contacts.h5 \
  /registry/default.tactus
done_step "Python answers without a server what it is answered through the proxy"
as nobody tactus-ros2 --topic=/touch 2>"$work/ros2.txt" &
bridge=$!
runners+=("$bridge")
wait_for "$bridge" grep -q "waits for a publisher of /touch" "$work/ros2.txt" ||
  { cat "$work/ros2.txt" >&2; die "tactus-ros2 does not wait for the skin"; }
grep -q "^tactus-ros2: skin cody-forearm, 16 x 24 " "$work/ros2.txt" ||
  { cat "$work/ros2.txt" >&2; die "tactus-ros2 has no stream"; }
done_step "tactus-ros2 has a stream through the proxy and waits for the skin"

mapfile -t words < <(words_of tactus-console)
as nobody "${words[@]}" &
runners+=("$!")
wait_for "$!" ask_console / as nobody || die "the unit's console does not serve"
[[ $(ask_console / as nobody) == *"<title>Tactus"* ]] ||
  die "the console has no page"
done_step "the console has its page"

quietly in_server trainctl simulate --protocol=random --contacts=4 --seed=3 \
  --out=/tmp/sim.h5
quietly in_server trainctl datasets create arm "${admin[@]}"
quietly in_server trainctl datasets upload arm --data=/tmp/sim.h5 "${admin[@]}"
stored=$(datasets)
[[ $stored == *arm* ]] || die "the dataset is not listed: $stored"
stop_all
# still_there WHEN
still_there() {
  start_server
  [[ $(datasets) == "$stored" ]] || die "$1: the datasets are $(datasets)"
  stop_all
  done_step "$1: the trials are served"
}
version_of() { in_server dpkg --status "$1" | sed -n 's/^Version: //p'; }

install_with in_server "${new[@]}"
for package in "${ours[@]}"; do
  [[ $(version_of "$package") == "$newer" ]] || die "$package was not upgraded"
done
[[ $(id_of passwd) == "$user" ]] || die "the user is another one"
still_there "upgraded"
quietly in_server apt-get -qq remove --yes "${ours[@]}"
for file in bin/tactusd bin/tactus-ros2 share/tactus \
  lib/python3/dist-packages/tactus; do
  [[ ! -e $root/usr/$file ]] || die "/usr/$file is still there"
done
[[ -s $root/var/lib/tactus/catalog.db && -s $root/etc/tactus/haproxy.cfg ]] ||
  die "removing took data or configuration"
done_step "removed: data and configuration stay"
install_with in_server "${new[@]}"
still_there "installed again"

quietly in_server apt-get -qq purge --yes "${ours[@]}"
left=$(find "$root"/{etc,run/systemd,usr,var/lib} -name '*tactus*' \
  -not -path "$root/var/lib/apt/*" | sed "s|^$root||")
[[ -z $left ]] || die "purging left: $left"
[[ -z $(id_of passwd)$(id_of group) ]] || die "the user tactus is still there"
done_step "purged without a question: data, configuration and user are gone"

say "the packages install, serve, upgrade, go, and leave nothing"
