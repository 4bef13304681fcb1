# Sourced by deploy/cluster.sh and tests/cluster/run.sh: PostgreSQL, servers that
# share its catalogue, and HAProxy before them, all on this machine, in $work.
# Uses $bin, and adds what it starts to the array $programs, the last ones first.
# shellcheck shell=bash disable=SC2154,SC2034

readonly POSTGRES=/usr/lib/postgresql/15/bin

# PostgreSQL refuses to run as root.
as_postgres() {
  if [[ $(id -u) -eq 0 ]]; then
    setpriv --reuid=postgres --regid=postgres --init-groups "$@"
  else
    "$@"
  fi
}

# make_postgres: an empty database cluster in $work/pg.
make_postgres() {
  install -d -m 755 "$work"
  install -d -m 700 "$work/pg"
  [[ $(id -u) -ne 0 ]] || chown postgres "$work/pg"
  as_postgres "$POSTGRES/initdb" --auth=trust --username=tactus --encoding=UTF8 \
    --locale=C --pgdata="$work/pg/data" >"$work/postgres.log" 2>&1
  catalog="postgresql:///postgres?host=$work/pg&user=tactus"
}

# start_postgres: waits until it serves. Its process is $postgres.
start_postgres() {
  local run=("$POSTGRES/postgres" -D "$work/pg/data" -k "$work/pg"
    -c listen_addresses= -c max_connections=60)
  # No function, so that the process is that of PostgreSQL.
  [[ $(id -u) -ne 0 ]] ||
    run=(setpriv --reuid=postgres --regid=postgres --init-groups "${run[@]}")
  "${run[@]}" >>"$work/postgres.log" 2>&1 &
  postgres=$!
  programs=("$postgres" "${programs[@]}")
  local i
  for ((i = 0; i < 200; ++i)); do
    ! as_postgres "$POSTGRES/pg_isready" -q -h "$work/pg" -U tactus || return 0
    sleep 0.05
  done
  echo "cluster: PostgreSQL does not start:" >&2
  cat "$work/postgres.log" >&2
  return 1
}

# start_replica N [FLAGS...]: a server at unix:$work/replica-N.sock and at
# 127.0.0.1:$((base_port + N)). Its process is ${replica[N]}.
declare -A replica
start_replica() {
  local number=$1
  rm -f "$work/replica-$number.sock"
  "$bin/tactusd" --listen="127.0.0.1:$((base_port + number))" \
    --listen="unix:$work/replica-$number.sock" --catalog="$catalog" \
    --blobs="$work/shared" "${@:2}" >>"$work/replica-$number.log" 2>&1 &
  replica[$number]=$!
  programs=("$!" "${programs[@]}")
  await_file cluster "$work/replica-$number.sock" "$!" \
    "$work/replica-$number.log"
}

# start_worker N [FLAGS...]: a worker of the same catalogue. Its process is
# ${worker[N]}.
declare -A worker
start_worker() {
  local number=$1
  "$bin/tactus-worker" --catalog="$catalog" --blobs="$work/shared" "${@:2}" \
    >>"$work/worker-$number.log" 2>&1 &
  worker[$number]=$!
  programs=("$!" "${programs[@]}")
}

# start_proxy COUNT: HAProxy at 127.0.0.1:50051 before that many replicas; with
# $proxy_port at another port.
start_proxy() {
  local number servers=""
  for ((number = 1; number <= $1; ++number)); do
    servers+="    server replica-$number 127.0.0.1:$((base_port + number))\\n"
  done
  sed -e "s/^    server local .*/${servers%\\n}/" -e '/^    server alone /d' \
    -e "s/:50051\"/:${proxy_port:-50051}\"/" deploy/haproxy.cfg \
    >"$work/haproxy.cfg"
  TACTUS_BIND=127.0.0.1 haproxy -db -f "$work/haproxy.cfg" \
    >>"$work/haproxy.log" 2>&1 &
  proxy=$!
  programs=("$!" "${programs[@]}")
}
