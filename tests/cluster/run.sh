#!/usr/bin/env bash
# What servers of one catalogue promise (docs/scaling.md), with real programs:
# PostgreSQL, HAProxy, three servers, robots, uploads, trainings, and what kills
# them.
#
#   tests/cluster/run.sh --quick BIN    programs in BIN; three minutes
#   tests/cluster/run.sh --ranks BIN    trainings of several ranks (ranks.sh)
#   tests/cluster/run.sh --chaos BIN    twenty minutes of faults (chaos.sh)
#
# Prints one line for each promise. Exits with 77 if PostgreSQL or HAProxy is not
# installed.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

bin=build/release/bin other=""
for arg in "$@"; do
  case "$arg" in
    --quick) ;;
    --ranks | --chaos) other=${arg#--} ;;
    -h | --help) sed -n '2,/^set /{/^set /d;s/^# \{0,1\}//;p}' "$0"; exit 0 ;;
    -*) echo "cluster: unknown option '$arg' (try --help)" >&2; exit 2 ;;
    *) bin=$arg ;;
  esac
done
[[ -z $other ]] || exec "tests/cluster/$other.sh" "$bin"
for program in /usr/lib/postgresql/15/bin/initdb haproxy; do
  command -v "$program" >/dev/null || {
    echo "cluster: $program is not installed"
    exit 77
  }
done

work=$(mktemp -d /tmp/tactus-cluster.XXXXXX)
programs=()
# shellcheck source=deploy/demo-parts.sh
. deploy/demo-parts.sh
# shellcheck source=deploy/cluster-parts.sh
. deploy/cluster-parts.sh
clean_up() {
  local status=$?
  stop_programs "${programs[@]}"
  if [[ $status -ne 0 ]]; then
    echo "cluster: FAILED" >&2
    tail -n 20 "$work"/*.log >&2
  fi
  rm -rf "$work"
}
trap clean_up EXIT
die() { echo "cluster: $*" >&2; exit 1; }
promise() { printf '%4d s  %s\n' "$SECONDS" "$*"; }

# Ports that other tests do not use, and that no outgoing connection gets.
# shellcheck disable=SC2034
base_port=$((23000 + $$ % 1000 * 8)) proxy_port=$((base_port))
at() { echo "--server=unix:$work/replica-$1.sock"; }
trainctl() { "$bin/trainctl" "$@"; }
field() { /usr/bin/python3 -c 'import json, sys
value = json.load(sys.stdin)
for name in sys.argv[1:]:
    value = value[int(name) if name.isdigit() else name]
print(value)' "$@"; }
# await COMMAND...: until it succeeds, within half a minute.
await() {
  local i
  for ((i = 0; i < 300; ++i)); do
    ! "$@" >/dev/null 2>&1 || return 0
    sleep 0.1
  done
  die "not within 30 s: $*"
}

make_postgres
start_postgres
for number in 1 2 3; do start_replica "$number"; done
start_proxy 3
promise "three servers of one catalogue behind a proxy"

# ---------------------------------------------------------------- data
trainctl simulate --protocol=grid --skin=good --stiffness 250 1600 --sample=120 \
  --seed=1 --out="$work/trials.h5" >/dev/null
trainctl datasets create skin "$(at 1)" >/dev/null
trainctl datasets upload skin --data="$work/trials.h5" "$(at 2)" >/dev/null
trials=$(trainctl datasets show skin --json "$(at 3)" | field versions 0 trials)
[[ $trials -gt 100 ]] || die "the upload has $trials trials"
promise "what one server stores, the others have: $trials trials"

# ------------------------------------------------- a job whose server dies
# alone, for comparison: a server with its own catalogue
"$bin/tactusd" --listen="unix:$work/alone.sock" --data-dir="$work/alone" \
  >"$work/alone.log" 2>&1 &
programs=("$!" "${programs[@]}")
await_file cluster "$work/alone.sock" "$!" "$work/alone.log"
alone=--server=unix:$work/alone.sock
trainctl datasets create skin "$alone" >/dev/null
trainctl datasets upload skin --data="$work/trials.h5" "$alone" >/dev/null
train=(train --dataset=skin --model=skin --preset=paper --networks=1
  --epochs=12 --seed=3)
trainctl "${train[@]}" "$alone" >/dev/null 2>&1
wanted=$(trainctl models show skin@1 --json "$alone" | field sha256)

job=$(trainctl "${train[@]}" --detach --json "$(at 1)" | field name)
runner=""
for ((i = 0; i < 200 && ${#runner} == 0; ++i)); do
  for number in 1 2 3; do
    if pgrep -P "${replica[$number]}" tactus-trainer >/dev/null; then
      runner=$number
    fi
  done
  sleep 0.05
done
[[ -n $runner ]] || die "no server runs $job"
sleep 1
kill -KILL "${replica[$runner]}"
killed=$SECONDS
other=$((runner % 3 + 1))
trainctl jobs watch "${job#operations/}" "$(at "$other")" >"$work/watch.log" 2>&1 ||
  die "the job does not end: $(cat "$work/watch.log")"
promise "a training whose server was killed has ended at another one, after $((SECONDS - killed)) s"
got=$(trainctl models show skin@1 --json "$(at "$other")" | field sha256)
[[ $got == "$wanted" ]] || die "its bundle is $got, that of one server alone $wanted"
promise "its bundle has the same SHA-256 as that of one server alone"
start_replica "$runner"

# ------------------------------------------------------------- promotion
await trainctl models show skin@1 "$(at "$runner")"
trainctl models promote skin@1 --alias=arm "$(at 1)" >"$work/promote.log"
! grep -q "does not serve" "$work/promote.log" || die "$(cat "$work/promote.log")"
for number in 1 2 3; do
  served=$(trainctl models alias arm --json "$(at "$number")" | field model_version)
  [[ $served == models/skin/versions/1 ]] || die "server $number has $served"
done
promise "when a promotion has returned, all servers serve the version"

# ------------------------------------------------ streams, server killed
stream() {
  "$bin/tactus-stream" --server="127.0.0.1:$proxy_port" --driver=sim --trials=12 \
    --seed=5 --parallel=6 --rate=real --json --posteriors="$1" >"$1.json" 2>/dev/null
}
stream "$work/undisturbed" &
undisturbed=$!
wait "$undisturbed" || die "the robots fail"
stream "$work/disturbed" &
disturbed=$!
sleep 3
kill -KILL "${replica[2]}"
sleep 2
start_replica 2
wait "$disturbed" || die "the robots fail when a server is killed"
cmp "$work/undisturbed" "$work/disturbed" ||
  die "the answers differ when a server is killed"
promise "12 contacts of 6 robots have the same answers, bit for bit, when a server is killed"

# -------------------------------------------------- the database restarts
stream "$work/restarted" &
restarted=$!
sleep 2
kill -KILL "$postgres"
wait "$postgres" 2>/dev/null || true
# Its children see that it has gone, and end.
sleep 1
! trainctl datasets list "$(at 1)" >/dev/null 2>"$work/away" ||
  die "datasets are listed without the database"
grep -q CATALOG_UNAVAILABLE "$work/away" || die "$(cat "$work/away")"
"$bin/tactus-stream" "$(at 1)" --driver=sim --trials=2 --rate=max --json \
  >"$work/new.json" 2>/dev/null || die "a new stream is refused without the database"
rm -f "$work/pg/data/postmaster.pid"
start_postgres
await trainctl datasets list "$(at 1)"
wait "$restarted" || die "the robots fail while the database is away"
cmp "$work/undisturbed" "$work/restarted" ||
  die "the answers differ when the database is away"
promise "while the database is away streams go on with the same answers, and new ones begin"

# ------------------------------------------------------------------ tokens
trainctl tokens create --name=ann --role=admin --file="$work/shared/tokens" \
  >"$work/ann.token" 2>/dev/null
trainctl tokens create --name=bob --role=admin --file="$work/shared/tokens" \
  >"$work/bob.token" 2>/dev/null
for number in 4 5; do start_replica "$number" --tokens="$work/shared/tokens"; done
for number in 4 5; do
  trainctl datasets list "$(at "$number")" --token-file="$work/bob.token" \
    >/dev/null || die "server $number does not know a token"
done
trainctl tokens remove --name=bob --file="$work/shared/tokens" >/dev/null 2>&1
sleep 1
for number in 4 5; do
  ! trainctl datasets list "$(at "$number")" --token-file="$work/bob.token" \
    >/dev/null 2>&1 || die "server $number knows a token that was removed"
  trainctl datasets list "$(at "$number")" --token-file="$work/ann.token" \
    >/dev/null || die "server $number does not know a token that was kept"
done
promise "a token that was removed works at no server a second later"

# ----------------------------------------------------------------- workers
for number in "${!replica[@]}"; do
  kill -TERM "${replica[$number]}"
  wait "${replica[$number]}" 2>/dev/null || true
done
start_replica 6 --jobs=none
# A bundle names its operation, so both servers have done as many.
trainctl models promote skin@1 --alias=arm "$alone" >/dev/null
start_worker 1
start_worker 2
trainctl "${train[@]}" "$alone" >/dev/null 2>&1
wanted=$(trainctl models show skin@2 --json "$alone" | field sha256)
job=$(trainctl "${train[@]}" --detach --json "$(at 6)" | field name)
trainer_of() { pgrep -P "$1" tactus-trainer >/dev/null; }
runner=""
for ((i = 0; i < 400 && ${#runner} == 0; ++i)); do
  for number in 1 2; do
    ! trainer_of "${worker[$number]}" || runner=$number
  done
  sleep 0.05
done
[[ -n $runner ]] || die "no worker runs $job"
sleep 1
kill -KILL "${worker[$runner]}"
killed=$(date +%s%N)
await trainer_of "${worker[$((3 - runner))]}"
promise "a job whose worker was killed goes on at another one after $((($(date +%s%N) - killed) / 1000000)) ms"
trainctl jobs watch "${job#operations/}" "$(at 6)" >"$work/watch.log" 2>&1 ||
  die "the job does not end: $(cat "$work/watch.log")"
got=$(trainctl models show skin@2 --json "$(at 6)" | field sha256)
[[ $got == "$wanted" ]] || die "its bundle is $got, that of one server alone $wanted"
promise "its bundle, which a server without jobs serves, is the same"
for number in 1 2; do kill -KILL "${worker[$number]}" 2>/dev/null || true; done

# ------------------------------------------------------------------- Slurm
if command -v slurmctld >/dev/null; then
  tests/cluster/slurm.sh "$work/slurm" >"$work/slurm.log" 2>&1 &
  programs=("$!" "${programs[@]}")
  export SLURM_CONF=$work/slurm/slurm.conf
  await test -e "$work/slurm/ready"
  trainctl "${train[@]}" "$alone" >/dev/null 2>&1
  wanted=$(trainctl models show skin@3 --json "$alone" | field sha256)
  start_worker 3 --jobs=slurm
  trainctl "${train[@]}" "$(at 6)" >"$work/train.log" 2>&1 ||
    die "$(cat "$work/train.log")"
  ran=$(squeue --noheader --states=all --format=%T | sort | uniq -c | xargs)
  got=$(trainctl models show skin@3 --json "$(at 6)" | field sha256)
  [[ $got == "$wanted" ]] ||
    die "the bundle of Slurm is $got, that of one server alone $wanted"
  [[ $ran == "1 COMPLETED" ]] || die "Slurm has run: $ran"
  promise "a training that Slurm has run makes the same bundle"
fi
start_replica 1
start_replica 2

# ---------------------------------------------------------- copies of blobs
for log in first second; do
  start_replica 7 --data-dir="$work/own" --blob-cache=64M
  kill -TERM "${replica[7]}"
  wait "${replica[7]}" || die "server 7 ends with an error"
  mv "$work/replica-7.log" "$work/$log.log"
done
grep -q "blob cache: [1-9][0-9]* reads found their blob and 0 did not" \
  "$work/second.log" || die "$(cat "$work/second.log")"
promise "a server that starts again reads its models from its own disk"

silent=$(trainctl server info "$(at 1)" | grep -c '^replicas/.*server' || true)
[[ $silent -ge 3 ]] || die "server info names $silent servers"
promise "all promises are kept"
