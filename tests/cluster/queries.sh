#!/usr/bin/env bash
# What servers of one catalogue ask PostgreSQL in an hour without work, and for
# one promotion: the tables of docs/scaling.md, in Markdown.
#
#   tests/cluster/queries.sh [--seconds=N] [--jobs=N] [--most=N] BIN
#
#   --seconds=N   how long nothing happens, for each number of servers (30)
#   --jobs=N      trainings that have ended and are kept (20)
#   --most=N      exits 1 if one server makes more statements in an hour
#
# Counts each statement, BEGIN and COMMIT too, with pg_stat_statements. Exits
# with 77 if PostgreSQL or that extension is not installed.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

bin=build/release/bin seconds=30 jobs=20 most=0
for arg in "$@"; do
  case "$arg" in
    --seconds=*) seconds=${arg#*=} ;;
    --jobs=*) jobs=${arg#*=} ;;
    --most=*) most=${arg#*=} ;;
    -h | --help) sed -n '2,/^set /{/^set /d;s/^# \{0,1\}//;p}' "$0"; exit 0 ;;
    -*) echo "queries: unknown option '$arg' (try --help)" >&2; exit 2 ;;
    *) bin=$arg ;;
  esac
done
for part in /usr/lib/postgresql/15/bin/initdb /usr/bin/psql \
  /usr/lib/postgresql/15/lib/pg_stat_statements.so; do
  [[ -e $part ]] || {
    echo "queries: $part is not installed"
    exit 77
  }
done

work=$(mktemp -d /tmp/tactus-queries.XXXXXX)
programs=()
# shellcheck source=deploy/demo-parts.sh
. deploy/demo-parts.sh
# shellcheck source=deploy/cluster-parts.sh
. deploy/cluster-parts.sh
clean_up() {
  local status=$?
  stop_programs "${programs[@]}"
  [[ $status -eq 0 ]] || tail -n 20 "$work"/*.log >&2
  rm -rf "$work"
}
trap clean_up EXIT
# Ports that other tests do not use, and that no outgoing connection gets.
# shellcheck disable=SC2034
base_port=$((27000 + $$ % 500 * 8))
trainctl() { "$bin/trainctl" "$@" "--server=unix:$work/replica-1.sock"; }
# In a database that no server uses, so that this counting is not counted.
query() {
  psql --no-psqlrc --quiet --tuples-only --no-align --host="$work/pg" \
    --username=tactus --dbname=counts --command="$1"
}
# count WHAT [CONDITION]: a sum over the statements of all servers since forget.
count() {
  query "SELECT round(coalesce(sum($1), 0)) FROM pg_stat_statements s
    JOIN pg_database d ON d.oid = s.dbid
    WHERE d.datname = 'postgres' AND ${2:-true}"
}
forget() { query "SELECT pg_stat_statements_reset()" >/dev/null; }
hourly() { echo $(($1 * 3600 / seconds)); }
# Each transaction that writes asks for its number.
readonly WROTE="query LIKE '%pg_current_xact_id%'"

make_postgres
cat >>"$work/pg/data/postgresql.conf" <<'CONF'
shared_preload_libraries = 'pg_stat_statements'
CONF
start_postgres
psql --no-psqlrc --quiet --host="$work/pg" --username=tactus --dbname=postgres \
  --command="CREATE DATABASE counts"
query "CREATE EXTENSION pg_stat_statements"

start_replica 1
"$bin/trainctl" simulate --protocol=grid --skin=good --stiffness 250 1600 \
  --sample=60 --seed=1 --out="$work/trials.h5" >/dev/null
trainctl datasets create skin >/dev/null
trainctl datasets upload skin --data="$work/trials.h5" >/dev/null 2>&1
for ((i = 0; i < jobs; ++i)); do
  trainctl train --dataset=skin --model=skin --preset=paper --networks=0 \
    --hmms-per-class=1 --skip-unusable --seed=1 >/dev/null 2>&1
done

echo "| servers | statements | transactions | of these, with a write | rows read |"
echo "|---|---|---|---|---|"
promotions=()
version=0
for servers in 1 2 3; do
  [[ $servers -eq 1 ]] || start_replica "$servers"
  # What a start asks is not idle.
  sleep 3
  forget
  sleep "$seconds"
  statements=$(hourly "$(count calls)")
  [[ $servers -ne 1 ]] || alone=$statements
  printf '| %d | %d | %d | %d | %d |\n' "$servers" "$statements" \
    "$(hourly "$(count calls "query = 'COMMIT'")")" \
    "$(hourly "$(count calls "$WROTE")")" \
    "$(hourly "$(count rows "query LIKE 'SELECT key%'")")"
  # Ten promotions, and as long without one to compare with.
  before=$(date +%s%N)
  forget
  for ((i = 0; i < 10; ++i)); do
    version=$((version % jobs + 1))
    trainctl models promote "skin@$version" --alias=arm >/dev/null 2>&1
  done
  took=$(($(date +%s%N) - before))
  busy=$(count calls) busy_writes=$(count calls "$WROTE")
  forget
  sleep "$((took / 1000000000)).$(printf %09d $((took % 1000000000)))"
  promotions+=("| $servers | $(((busy - $(count calls)) / 10)) | $(((busy_writes - $(count calls "$WROTE")) / 10)) | $((took / 10000000)) |")
done
echo
echo "| servers | statements | transactions that write | time, ms |"
echo "|---|---|---|---|"
printf '%s\n' "${promotions[@]}"
if [[ $most -gt 0 && $alone -gt $most ]]; then
  echo "queries: one idle server makes $alone statements in an hour; at most $most were expected" >&2
  exit 1
fi
