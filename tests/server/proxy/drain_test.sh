#!/usr/bin/env bash
# Two servers behind HAProxy with deploy/haproxy.cfg, of which one drains while
# robots stream: its streams go on there, new ones land at the other server, and
# none fails.
#
#   tests/server/proxy/drain_test.sh BIN    programs in BIN; about 20 s
#
# Exits with 77 if HAProxy is not installed.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../../.."

bin=${1:-build/release/bin}
command -v haproxy >/dev/null || { echo "drain: haproxy is not installed"; exit 77; }

work=$(mktemp -d /tmp/tactus-drain.XXXXXX)
programs=()
# shellcheck source=deploy/demo-parts.sh
. deploy/demo-parts.sh
# shellcheck source=deploy/cluster-parts.sh
. deploy/cluster-parts.sh
clean_up() {
  local status=$?
  stop_programs "${programs[@]}"
  if [[ $status -ne 0 ]]; then
    echo "drain: FAILED" >&2
    tail -n 20 "$work"/*.log >&2
  fi
  rm -rf "$work"
}
trap clean_up EXIT
die() { echo "drain: $*" >&2; exit 1; }

# Ports that other tests do not use, and that no outgoing connection gets.
base_port=$((11000 + $$ % 1000 * 4)) proxy_port=$((base_port))

# serve N: a server at 127.0.0.1:$((base_port + N)), without a catalogue.
declare -A server
serve() {
  rm -f "$work/$1.sock"
  "$bin/tactusd" --listen="127.0.0.1:$((base_port + $1))" \
    --listen="unix:$work/$1.sock" --drain-notice-ms=2000 \
    --drain-grace-ms=6000 >>"$work/server-$1.log" 2>&1 &
  server[$1]=$!
  programs=("$!" "${programs[@]}")
  await_file drain "$work/$1.sock" "$!" "$work/server-$1.log"
}

# robot NAME CONTACTS ADDRESS [FLAGS...]: streams simulated contacts.
robot() {
  "$bin/tactus-stream" --client-id="$1" --trials="$2" --server="$3" \
    --seed=7 --posteriors="$work/$1" "${@:4}" >>"$work/robot-$1.log" 2>&1
}

# streams N: how many streams have begun at server N.
streams() { grep -c 'began:' "$work/server-$1.log" || true; }

for number in 1 2; do serve "$number"; done
start_proxy 2
proxy=127.0.0.1:$proxy_port
for ((i = 0; i < 100; ++i)); do
  ! robot wait 1 "$proxy" --reconnect=0 || break
  sleep 0.1
done
# The right answers, without proxy and drain.
robot right-1 1 "unix:$work/1.sock"
robot right-2 2 "unix:$work/1.sock"

# The places of some names: four robots at the server that drains, two at the
# other one.
drained=1 other=2
here=() there=()
for ((i = 0; i < 40 && (${#here[@]} < 4 || ${#there[@]} < 2); ++i)); do
  robot "name-$i" 1 "$proxy" --reconnect=0 || die "a stream fails before the drain"
  if grep -q "\"name-$i\" began" "$work/server-$drained.log"; then
    here+=("name-$i")
  else
    there+=("name-$i")
  fi
done
[[ ${#here[@]} -ge 4 && ${#there[@]} -ge 2 ]] || die "one server gets all streams"
# In real time: one of 12 s, which outlasts the grace, and the others of 6 s,
# which must not be cut off.
long=${here[3]}
short=("${here[@]:0:3}" "${there[@]:0:2}")
begun=$(($(streams 1) + $(streams 2)))
robots=()
robot "$long" 2 "$proxy" --rate=real &
robots+=("$!")
for name in "${short[@]}"; do
  robot "$name" 1 "$proxy" --rate=real --reconnect=0 &
  robots+=("$!")
done
until [[ $(($(streams 1) + $(streams 2))) -ge $((begun + 6)) ]]; do sleep 0.05; done

kill -TERM "${server[$drained]}"
begun=$(streams "$other")
during=0
until grep -q ': draining' "$work/server-$drained.log"; do
  robot "new-$during" 1 "$proxy" --reconnect=0 ||
    die "a new stream fails in the notice: $(cat "$work/robot-new-$during.log")"
  during=$((during + 1))
  [[ $during -lt 500 ]] || die "the notice does not end"
done
# By now the proxy has seen it.
before=$(streams "$drained")
for i in 1 2 3 4 5 6; do
  robot "late-$i" 1 "$proxy" --reconnect=0 || die "a new stream fails in the grace"
done
[[ $(streams "$drained") -eq $before ]] || die "a draining server gets streams"
[[ $(streams "$other") -gt $begun ]] || die "the other server gets no streams"
kept=$(sed -n 's/.*: draining \([0-9]*\) streams/\1/p' "$work/server-$drained.log")
[[ $kept -ge 2 ]] || die "server $drained had $kept streams left"

for robot in "${robots[@]}"; do
  wait "$robot" || die "a robot fails: $(cat "$work"/robot-*.log)"
done
for name in "${short[@]}"; do
  cmp "$work/right-1" "$work/$name" || die "the answers to $name differ"
  # It was placed once, and streamed once.
  [[ $(cat "$work"/server-*.log | grep -c "\"$name\" began") -eq 2 ]] ||
    die "$name was moved"
done
cmp "$work/right-2" "$work/$long" || die "the answers to $long differ"
# What outlasts the grace goes on at the other server.
grep -q "\"$long\" began" "$work/server-$other.log" || die "$long was not moved"
wait "${server[$drained]}" || die "server $drained ended with an error"

# It comes back, and gets its robots again.
before=$(streams "$drained")
serve "$drained"
for ((i = 0; i < 50 && $(streams "$drained") == before; ++i)); do
  robot "$long" 1 "$proxy" --reconnect=0 || die "a stream fails after the restart"
  sleep 0.1
done
[[ $(streams "$drained") -gt $before ]] || die "a restarted server gets no streams"
echo "drain: $kept streams went on while $((during + 6)) new ones began elsewhere"
