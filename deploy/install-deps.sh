#!/usr/bin/env bash
# Installs the Debian 12 packages that Tactus needs.
#
#   deploy/install-deps.sh            to build and run all programs
#   deploy/install-deps.sh --tests    and to build and run tests and benchmarks
#   deploy/install-deps.sh --build    to build tactusd, tactus-trainer, trainctl
#                                     and tactus-console without its page
#   deploy/install-deps.sh --runtime  to run these four, built already
#   deploy/install-deps.sh --proxy    to run HAProxy before tactusd
#   deploy/install-deps.sh --page     to build the console's page
#   deploy/install-deps.sh --python   to build and use the Python package
#   deploy/install-deps.sh --image    to run deploy/check-image.sh
#   deploy/install-deps.sh --packages to run deploy/packages.sh
#   deploy/install-deps.sh --embedded to build libtactus_c
#   deploy/install-deps.sh --arm64    to run deploy/arm64.sh
#   deploy/install-deps.sh --list     (with any of these) only prints the names
#
# Runs as root, or as a user who may use sudo. Does nothing, and does not use the
# network, when all packages are installed already.
set -euo pipefail

# The server and trainctl: compiler, gRPC and protobuf, the numerics that they
# link; trial files, JSON, pictures of skins, USB adapters.
readonly BUILD=(
  cmake
  g++
  libabsl-dev
  libboost-dev
  libcli11-dev
  libeigen3-dev
  libgrpc++-dev
  libhdf5-dev
  libhwy-dev
  libisal-dev
  liblz4-dev
  libnghttp2-dev
  libopencv-core-dev
  libopencv-imgproc-dev
  libpq-dev
  libprotobuf-dev
  libprotoc-dev
  libspdlog-dev
  libsqlitecpp-dev
  libssl-dev
  libusb-1.0-0-dev
  libzstd-dev
  ninja-build
  nlohmann-json3-dev
  pkgconf
  prometheus-cpp-dev
  protobuf-compiler
  protobuf-compiler-grpc
  zlib1g-dev
)
# The shared libraries behind them; each brings its own dependencies.
readonly RUNTIME=(
  libabsl20220623
  libgrpc++1.51
  libhdf5-103-1
  libhwy1
  libisal2
  liblz4-1
  libnghttp2-14
  libopencv-core406
  libopencv-imgproc406
  libpq5
  libprometheus-cpp-core1.0
  libprotobuf32
  libspdlog1.10
  libsqlite3-0
  libssl3
  libusb-1.0-0
  libzstd1
  zlib1g
)
# The proxy before tactusd (deploy/haproxy.cfg).
readonly PROXY=(
  haproxy
)
# An image without a container engine: its base, and its builder.
readonly IMAGE=(
  buildah
  iproute2
  mmdebstrap
  python3-yaml
)
# What the programs can do without: robots' URDF files and their kinematics.
readonly PROGRAMS=(
  liborocos-kdl-dev
  liburdfdom-dev
)
# The console's page.
readonly PAGE=(
  npm
)
# The Python package (client/python), and what it needs where it runs.
readonly PYTHON=(
  protobuf-compiler
  protobuf-compiler-grpc
  pybind11-dev
  python3-build
  python3-dev
  python3-grpcio
  python3-numpy
  python3-protobuf
  python3-setuptools
  python3-venv
  python3-wheel
)
# Debian packages with all that the programs can do: ROS 1's bags, topics of ROS 2,
# and trainings by several processes; and with the Python package.
readonly PACKAGES=(
  cyclonedds-dev
  debhelper
  dh-python
  dpkg-dev
  help2man
  libopenmpi-dev
  librosbag-storage-dev
  lintian
  pybind11-dev
  python3-build
  python3-dev
  python3-setuptools
  python3-wheel
)
# The C interface alone.
readonly EMBEDDED=(
  cmake
  g++
  libabsl-dev
  libeigen3-dev
  libhwy-dev
  libisal-dev
  libprotobuf-dev
  libssl-dev
  ninja-build
  pkgconf
  protobuf-compiler
)
# The same for 64-bit ARM, on another processor.
readonly ARM64=(
  cmake
  g++-aarch64-linux-gnu
  mmdebstrap
  ninja-build
  protobuf-compiler
  python3-h5py
  qemu-user-static
)
# The tests, the benchmarks, and the independent references of both.
readonly TESTS=(
  ccache
  chromium
  clang-14
  clang-format
  cyclonedds-dev
  doxygen
  fastddsgen
  gnuplot-nox
  haproxy
  libclang-rt-14-dev
  libfastcdr-dev
  libfastrtps-dev
  libghmm-dev
  libgmock-dev
  libgtest-dev
  libopenmpi-dev
  librosbag-storage-dev
  libsundials-dev
  libumockdev-dev
  openmpi-bin
  mypy
  openssl
  postgresql-15
  prometheus
  python3-empy
  python3-h5py
  python3-ipykernel
  python3-matplotlib
  python3-nbclient
  python3-nbformat
  python3-pandas
  python3-prometheus-client
  python3-rosidl
  python3-scipy
  python3-sklearn
  python3-tqdm
  rosidl-tools
  rsync
  shellcheck
  slurm-client
  slurmctld
  slurmd
  sqlite3
  umockdev
)

usage() {
  sed -n '2,/^set /{/^set /d;s/^# \{0,1\}//;p}' "$0"
}

packages=("${BUILD[@]}" "${PROGRAMS[@]}" "${PAGE[@]}")
list_only=no
for arg in "$@"; do
  case "$arg" in
    --tests) packages+=("${PYTHON[@]}" "${TESTS[@]}") ;;
    --build) packages=("${BUILD[@]}") ;;
    --runtime) packages=("${RUNTIME[@]}") ;;
    --proxy) packages=("${PROXY[@]}") ;;
    --page) packages=("${PAGE[@]}") ;;
    --python) packages=("${PYTHON[@]}") ;;
    --image) packages=("${IMAGE[@]}") ;;
    --packages) packages+=("${PACKAGES[@]}") ;;
    --embedded) packages=("${EMBEDDED[@]}") ;;
    --arm64) packages=("${ARM64[@]}") ;;
    --list) list_only=yes ;;
    -h | --help) usage; exit 0 ;;
    *) echo "install-deps: unknown option '$arg'" >&2; usage >&2; exit 2 ;;
  esac
done

if [[ $list_only == yes ]]; then
  printf '%s\n' "${packages[@]}"
  exit 0
fi

is_installed() {
  # Other packages of nodejs than Debian's bring npm along.
  [[ $1 != npm ]] || ! command -v npm >/dev/null || return 0
  dpkg-query --show --showformat='${db:Status-Status}\n' "$1" 2>/dev/null |
    grep -qx installed
}

missing=()
for package in "${packages[@]}"; do
  is_installed "$package" || missing+=("$package")
done
if [[ ${#missing[@]} -eq 0 ]]; then
  exit 0
fi

as_root=()
if [[ $(id -u) -ne 0 ]]; then
  if ! command -v sudo >/dev/null; then
    echo "install-deps: not root and no sudo; please install as root:" \
      "${missing[*]}" >&2
    exit 1
  fi
  as_root=(sudo)
fi

# A mirror may fail for a moment; three tries, each a little later.
try_apt_get() {
  local attempt
  for attempt in 1 2 3; do
    if "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
      apt-get -qq -o Dpkg::Use-Pty=0 -o DPkg::Lock::Timeout=120 "$@"; then
      return 0
    fi
    echo "install-deps: apt-get $1 failed (try $attempt of 3)" >&2
    sleep $((attempt * 5))
  done
  return 1
}

echo "install-deps: installing ${missing[*]}"
try_apt_get update
try_apt_get install --yes --no-install-recommends "${missing[@]}" >/dev/null
