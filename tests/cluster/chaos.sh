#!/usr/bin/env bash
# Minutes of faults: robots stream, datasets grow, models are trained and
# promoted, while servers, workers, the proxy and the database are killed and
# halted. What was acknowledged is looked for at the end.
#
#   tests/cluster/chaos.sh [--minutes=20] [--seed=1] BIN
#
# Prints each fault, then one line for each promise with what was counted. Exits
# with 1 if one is broken, and then keeps its folder. The seed gives the same
# faults at about the same times. tests/cluster/run.sh --chaos runs this.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

bin=build/release/bin minutes=20 seed=1
for arg in "$@"; do
  case "$arg" in
    --minutes=*) minutes=${arg#*=} ;;
    --seed=*) seed=${arg#*=} ;;
    -h | --help) sed -n '2,/^set /{/^set /d;s/^# \{0,1\}//;p}' "$0"; exit 0 ;;
    -*) echo "chaos: unknown option '$arg' (try --help)" >&2; exit 2 ;;
    *) bin=$arg ;;
  esac
done
for program in /usr/lib/postgresql/15/bin/initdb haproxy; do
  command -v "$program" >/dev/null || {
    echo "chaos: $program is not installed"
    exit 77
  }
done

work=$(mktemp -d /tmp/tactus-chaos.XXXXXX)
programs=()
broken=0
# Notices of killed jobs go elsewhere while faults are made.
exec 9>&2
# shellcheck source=deploy/demo-parts.sh
. deploy/demo-parts.sh
# shellcheck source=deploy/cluster-parts.sh
. deploy/cluster-parts.sh
clean_up() {
  local status=$? pid
  touch "$work/stop"
  # shellcheck disable=SC2046
  kill $(jobs -p) 2>/dev/null || true
  for pid in "${programs[@]}"; do kill -CONT "$pid" 2>/dev/null || true; done
  stop_programs "${programs[@]}"
  wait
  if [[ $status -ne 0 ]]; then
    echo "chaos: FAILED; its folder is $work" >&9
    tail -n 5 "$work/faults" >&9 || true
  else
    rm -rf "$work"
  fi
}
trap clean_up EXIT
die() { echo "chaos: $*" >&2; exit 1; }
say() { printf '%4d s  %s\n' "$SECONDS" "$*"; }
# Ports that other tests do not use.
# shellcheck disable=SC2034
base_port=$((25000 + $$ % 500 * 8)) proxy_port=$((base_port))
trainctl() { "$bin/trainctl" --quiet "$@"; }
at() { echo "--server=unix:$work/replica-$1.sock"; }
any=--server=127.0.0.1:$proxy_port
json() { /usr/bin/python3 -c "import json, sys
value = json.load(sys.stdin)
$1"; }
stopped() { [[ -e $work/stop ]]; }
# again COMMAND...: until it succeeds, or until the end.
again() {
  until "$@" 2>>"$work/refused"; do
    ! stopped || return 1
    sleep 0.5
  done
}

stream() {
  "$bin/tactus-stream" "$any" --driver=sim --trials=12 --seed=5 --parallel=6 \
    --rate=real --json --posteriors="$1" >/dev/null 2>"$1.log"
}
robots() {
  local round=0
  while ! stopped; do
    round=$((round + 1))
    if ! stream "$work/robots-$round"; then
      # Without a proxy no stream begins, so that nothing was promised.
      ! grep -q "^tactus-stream: failed to connect" "$work/robots-$round.log" ||
        continue
      echo "failed: $(tail -n 1 "$work/robots-$round.log")"
    elif ! cmp -s "$work/undisturbed" "$work/robots-$round"; then
      echo "other answers in $work/robots-$round"
    else
      echo same
      rm "$work/robots-$round" "$work/robots-$round.log"
    fi
  done >"$work/robots"
}
make_dataset() {
  trainctl datasets show "$1" "$any" >/dev/null 2>&1 ||
    trainctl datasets create "$1" "$any" >/dev/null
}
uploads() {
  local number=0
  while ! stopped; do
    number=$((number + 1))
    again make_dataset "up$number" || return 0
    again trainctl datasets upload "up$number" --data="$work/few.h5" "$any" \
      >/dev/null || return 0
    echo "up$number" >>"$work/uploaded"
    sleep 1
  done
}
train_one() {
  trainctl train --dataset=skin --model=skin --preset=paper --networks=0 \
    --seed=3 --detach --json "$any" >"$work/job"
}
trainings() {
  while ! stopped; do
    again train_one || return 0
    json 'print(value["name"])' <"$work/job" >>"$work/trained"
    sleep 6
  done
}
newest_version() {
  trainctl models list skin --json "$any" >"$work/versions"
}
promotions() {
  local version
  while ! stopped; do
    again newest_version || return 0
    version=$(json 'print(max(int(v["name"].split("/")[-1])
        for v in (value if isinstance(value, list) else value["versions"])))' \
      <"$work/versions")
    again trainctl models promote "skin@$version" --alias=arm "$any" \
      >/dev/null || return 0
    echo "$version" >>"$work/promoted"
    sleep 2
  done
}

# ------------------------------------------------------------------- before
make_postgres
start_postgres
for number in 1 2 3; do
  start_replica "$number" --jobs=none --drain-notice-ms=1000
done
for number in 1 2; do start_worker "$number" --job-threads=1; done
start_proxy 3
trainctl simulate --protocol=grid --skin=good --stiffness 250 1600 --sample=40 \
  --seed=1 --out="$work/trials.h5" >/dev/null
trainctl simulate --protocol=grid --skin=good --sample=4 --seed=2 \
  --out="$work/few.h5" >/dev/null
make_dataset skin
trainctl datasets upload skin --data="$work/trials.h5" "$any" >/dev/null
train_one
json 'print(value["name"])' <"$work/job" >"$work/trained"
trainctl jobs watch "$(sed 's/.*\///' "$work/trained")" "$any" >/dev/null 2>&1
stream "$work/undisturbed" || die "the robots fail before any fault"
touch "$work/uploaded" "$work/promoted"
say "all parts run; $minutes minutes of faults begin, seed $seed"

# ------------------------------------------------------------------- faults
robots &
loops=("$!")
uploads &
loops+=("$!")
trainings &
loops+=("$!")
promotions &
loops+=("$!")
RANDOM=$seed
declare -A faults=()
fault() {
  faults[$1]=$((${faults[$1]:-0} + 1))
  say "$1 $2"
}
# A worker that found no database when it began has ended: whoever runs it
# starts it again, as systemd does.
keep_worker() {
  kill -0 "${worker[$1]}" 2>/dev/null || start_worker "$1" --job-threads=1
}
# halt SECONDS PID...: they hang.
halt() {
  kill -STOP "${@:2}"
  sleep "$1"
  kill -CONT "${@:2}"
}
database_processes() { pgrep -P "$postgres"; echo "$postgres"; }
end=$((SECONDS + minutes * 60))
while ((SECONDS < end)); do
  sleep "$((RANDOM % 4 + 1))"
  number=$((RANDOM % 3 + 1)) which=$((RANDOM % 2 + 1)) pause=$((RANDOM % 12 + 2))
  case $((RANDOM % 8)) in
    0)
      fault "kill a server" "$number"
      kill -KILL "${replica[$number]}"
      sleep "$((pause % 4))"
      start_replica "$number" --jobs=none --drain-notice-ms=1000
      ;;
    1)
      fault "halt a server" "$number, $pause s"
      halt "$pause" "${replica[$number]}"
      ;;
    2)
      fault "drain a server" "$number"
      kill -TERM "${replica[$number]}"
      wait "${replica[$number]}" || true
      start_replica "$number" --jobs=none --drain-notice-ms=1000
      ;;
    3)
      keep_worker "$which"
      fault "kill a worker" "$which"
      kill -KILL "${worker[$which]}"
      sleep "$((pause % 4))"
      start_worker "$which" --job-threads=1
      ;;
    4)
      keep_worker "$which"
      fault "halt a worker" "$which, $pause s"
      halt "$pause" "${worker[$which]}"
      ;;
    5)
      fault "kill the database" "for $((pause % 4 + 1)) s"
      kill -KILL "$postgres"
      # Its children see that it has gone, and end.
      sleep "$((pause % 4 + 1))"
      rm -f "$work/pg/data/postmaster.pid"
      start_postgres
      ;;
    6)
      fault "halt the database" "$((pause % 6 + 1)) s"
      mapfile -t halted < <(database_processes)
      halt "$((pause % 6 + 1))" "${halted[@]}" 2>/dev/null || true
      ;;
    7)
      fault "kill the proxy" ""
      kill -KILL "$proxy"
      wait "$proxy" 2>/dev/null || true
      start_proxy 3
      ;;
  esac
done 2>"$work/faults"

# -------------------------------------------------------------------- after
for which in 1 2; do keep_worker "$which"; done
touch "$work/stop"
for loop in "${loops[@]}"; do wait "$loop" || true; done
for kind in "${!faults[@]}"; do say "${faults[$kind]} x $kind"; done
# promise COUNT VIOLATIONS TEXT
promise() {
  say "$3: $1 of $(($1 + $2))"
  [[ $2 -eq 0 ]] || broken=1
}
# await_ends: until no job waits or runs.
await_ends() {
  local i
  for ((i = 0; i < 600; ++i)); do
    trainctl jobs list --json --limit=100000 "$(at 1)" >"$work/jobs" 2>/dev/null &&
      json 'sys.exit(any(j["state"] in ("queued", "running", "cancelling")
          for j in (value if isinstance(value, list) else value["operations"])))' \
        <"$work/jobs" && return 0
    sleep 0.5
  done
}
await_ends
same=$(grep -c '^same$' "$work/robots" || true)
promise "$same" "$(grep -vc '^same$' "$work/robots" || true)" \
  "runs of 12 contacts of 6 robots with the answers of an undisturbed run"
there=0 lost=0
while read -r name; do
  if trainctl datasets show "$name" "$(at $((there % 3 + 1)))" >/dev/null 2>&1; then
    there=$((there + 1))
  else
    lost=$((lost + 1))
  fi
done <"$work/uploaded"
promise "$there" "$lost" "uploads that were acknowledged and are there"
read -r done_jobs other_jobs versions < <(
  trainctl models list skin --json "$(at 2)" >"$work/versions"
  /usr/bin/python3 - "$work" <<'END'
import json, sys
work = sys.argv[1]
def items(name, key):
    value = json.load(open(f"{work}/{name}"))
    return value if isinstance(value, list) else value[key]
state = {job["name"]: job["state"] for job in items("jobs", "operations")}
names = open(f"{work}/trained").read().split()
good = sum(state.get(name) == "succeeded" for name in names)
print(good, len(names) - good, len(items("versions", "versions")))
END
)
promise "$done_jobs" "$other_jobs" "trainings that were acknowledged and succeeded"
promise "$done_jobs" "$((versions > done_jobs ? versions - done_jobs : done_jobs - versions))" \
  "versions, one of each training"
good=0 bad=0
for ((version = 1; version <= versions; ++version)); do
  wanted=$(trainctl models show "skin@$version" --json "$(at 3)" |
    json 'print(value["blob_sha256"])')
  if trainctl models export "skin@$version" --out="$work/bundle" "$(at 3)" \
    >"$work/export" 2>&1 && [[ $(sha256sum "$work/bundle") == "$wanted "* ]]; then
    good=$((good + 1))
  else
    bad=$((bad + 1))
    cat "$work/export"
  fi
  rm -f "$work/bundle"
done
promise "$good" "$bad" "versions with the bytes of their SHA-256"
served=$(for number in 1 2 3; do
  trainctl models alias arm --json "$(at "$number")" |
    json 'print(value["model_version"])'
done | sort -u)
last=$(tail -n 1 "$work/promoted")
if [[ $served == "models/skin/versions/$last" ]]; then
  promise "$(wc -l <"$work/promoted")" 0 "promotions, the last one served by all servers"
else
  promise 0 1 "promotions; servers have $(xargs <<<"$served"), the last one was $last"
fi
status=0
trainctl doctor --catalog="$catalog" --blobs="$work/shared" >"$work/doctor" 2>&1 ||
  status=$?
promise "$((status < 2))" "$((status >= 2))" "doctor finds no error"
[[ $broken -eq 0 ]] || die "a promise is broken"
say "all promises are kept"
