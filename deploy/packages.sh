#!/usr/bin/env bash
# Builds Tactus's packages for Debian 12 and leaves them in dist/; on a fresh
# clone this is all it takes:
#
#   deploy/packages.sh && sudo apt install ./dist/*.deb
#
#   tactus-server    tactusd, started by systemd behind HAProxy, and what trains
#   tactus-tools     trainctl, tactus-stream, tactus-load, tactus-fakeskin
#   tactus-console   the console, started by systemd
#   libtactus-dev    headers, libraries and protos for a robot's program
#   python3-tactus   the same for Python: tactus.Client, tactus.Classifier and
#                    tactus.TouchClassifier
#   tactus-ros2      the bridge to ROS 2, with the messages that it publishes
#
#   --version=VERSION  of the packages. Without it, that of CMakeLists.txt; if
#                      the commit is not tagged as this release, its time is
#                      added, so that newer packages have higher versions
#   --out=FOLDER       instead of dist/
#
# Installs what is missing (install-deps.sh --packages), compiles in
# build/packages and build/packages-python, and ends with lintian, whose errors
# are errors. On two cores it takes half an hour; less where ccache has what was
# compiled before.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
die() { echo "packages: $*" >&2; exit 1; }

version=""
out=dist
for arg in "$@"; do
  case "$arg" in
    --version=*) version=${arg#--version=} ;;
    --out=*) out=${arg#--out=} ;;
    -h | --help) sed -n '2,/^set /{/^set /d;s/^# \{0,1\}//;p}' "$0"; exit 0 ;;
    *) die "unknown option '$arg' (try --help)" ;;
  esac
done

deploy/install-deps.sh --packages

release=$(sed -nE 's/^project\(tactus VERSION ([0-9.]+) .*/\1/p' CMakeLists.txt)
[[ -n $release ]] || die "CMakeLists.txt names no version"
# A clone may be another user's.
git_here() { git -c safe.directory="$PWD" "$@" 2>/dev/null; }
if ! date=$(git_here log -1 --date=rfc2822 --format=%cd); then
  # An unpacked archive, which is of a release.
  date=$(date --rfc-email --reference=CMakeLists.txt)
elif [[ -z $version ]] &&
  ! git_here tag --points-at HEAD | grep -qx "v$release"; then
  version=$release+$(date --utc --date="$date" +%Y%m%d.%H%M%S)-1
fi
version=${version:-$release-1}

# dpkg-buildpackage leaves its results beside the folder that it builds in.
stage=build/debian
rm -rf "$stage"
mkdir -p "$stage/tactus"
cp -r deploy/debian "$stage/tactus/debian"
# npm may be another one than Debian's.
needed=$(deploy/install-deps.sh --packages --list | grep -vx npm | paste -sd, |
  sed 's/,/, /g')
sed -i "s/@BUILD@/$needed/" "$stage/tactus/debian/control"
{
  printf 'tactus (%s) bookworm; urgency=medium\n\n' "$version"
  printf '  * Built from the sources; CHANGELOG.md says what is new.\n\n'
  printf ' -- %s  %s\n' \
    "$(sed -n 's/^Maintainer: //p' deploy/debian/control)" "$date"
} >"$stage/tactus/debian/changelog"
(cd "$stage/tactus" && dpkg-buildpackage --build=binary --no-sign)

# Packages of one version only, so that `apt install dist/*.deb` has no choice.
mkdir -p "$out"
rm -f "$out"/*tactus*_*.deb
printf '\n== lintian\n'
as_root=()
[[ $(id -u) -ne 0 ]] || as_root=(--allow-root)
# Debian's archive wants a bug that asks for a new package.
lintian --no-cfg "${as_root[@]}" --fail-on error --tag-display-limit 0 \
  --suppress-tags initial-upload-closes-no-bugs \
  "$stage"/*.changes || die "lintian found errors"
mv "$stage"/*.deb "$out/"
printf '\n== packages\n'
for package in "$out"/*.deb; do
  printf '%-60s %6.2f MB\n' "$package" \
    "$(stat --format=%s "$package")e-6"
done
