#!/usr/bin/env bash
# Three servers that share one catalogue, a worker that runs their jobs,
# PostgreSQL and HAProxy, all on this machine: to see how a larger Tactus works
# (docs/scaling.md).
#
#   deploy/cluster.sh                three servers behind 127.0.0.1:50051
#   deploy/cluster.sh --port=50051   at another port
#   deploy/cluster.sh --servers=5    so many servers
#   deploy/cluster.sh --for=60       ends by itself after so many seconds
#   deploy/cluster.sh --bin=FOLDER   with programs that are built already
#
# Installs and builds what is missing, prints the addresses, and runs until
# Ctrl-C. Then it stops all that it started, and removes what it stored.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

proxy_port=50051
servers=3
seconds=infinity
bin=build/release/bin
build=yes
for arg in "$@"; do
  case "$arg" in
    --port=*) proxy_port=${arg#--port=} ;;
    --servers=*) servers=${arg#--servers=} ;;
    --for=*) seconds=${arg#--for=} ;;
    --bin=*) bin=${arg#--bin=} build=no ;;
    -h | --help) sed -n '2,/^set /{/^set /d;s/^# \{0,1\}//;p}' "$0"; exit 0 ;;
    *) echo "cluster.sh: unknown option '$arg' (try --help)" >&2; exit 2 ;;
  esac
done

# A unix socket's path is short.
work=$(mktemp -d /tmp/tactus-cluster.XXXXXX)
programs=()   # that we started, the last ones first
# shellcheck source=deploy/demo-parts.sh
. deploy/demo-parts.sh
# shellcheck source=deploy/cluster-parts.sh
. deploy/cluster-parts.sh
clean_up() {
  stop_programs "${programs[@]}"
  rm -rf "$work"
}
trap clean_up EXIT
trap 'exit 0' INT TERM

if [[ $build == yes ]]; then
  deploy/install-deps.sh --tests
  build_programs cluster tactusd tactus-trainer tactus-worker tactus-stream \
    trainctl
fi
# Used by cluster-parts.sh.
# shellcheck disable=SC2034
base_port=$((proxy_port + 1000))
make_postgres
start_postgres
for ((number = 1; number <= servers; ++number)); do
  start_replica "$number" --jobs=none --drain-notice-ms=2000
done
start_worker 1
start_proxy "$servers"
echo "robots and people: 127.0.0.1:$proxy_port"
echo "catalogue: $catalog"
for ((number = 1; number <= servers; ++number)); do
  echo "server $number: unix:$work/replica-$number.sock"
done
"$bin/trainctl" server info --server="unix:$work/replica-1.sock" |
  grep '^replicas/'
# In the background, so that Ctrl-C need not wait for it.
sleep "$seconds" &
programs=("$!" "${programs[@]}")
wait "$!"
