#!/usr/bin/env bash
# Rehearses docs/scaling.md: runs the commands of "From one server to three" as
# they stand there, with three servers on this machine. A robot streams and a
# training runs across the move.
#
#   tests/docs/scaling_test.sh BUILD_DIR
#
# Exits with 77 if PostgreSQL or HAProxy is not installed.
set -euo pipefail
source_dir=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
for program in /usr/lib/postgresql/15/bin/initdb haproxy; do
  command -v "$program" >/dev/null || {
    echo "scaling_test: $program is not installed"
    exit 77
  }
done

work=$(mktemp -d /tmp/tactus-scaling.XXXXXX)
programs=()
bin=$(realpath "$1/bin")
# shellcheck source=deploy/demo-parts.sh
. "$source_dir/deploy/demo-parts.sh"
# shellcheck source=deploy/cluster-parts.sh
. "$source_dir/deploy/cluster-parts.sh"
clean_up() {
  local children
  mapfile -t children < <(cat "$work"/*.pid 2>/dev/null)
  kill -KILL "${children[@]}" 2>/dev/null || true
  stop_programs "${programs[@]}"
  rm -rf "$work"
}
trap clean_up EXIT
cd "$work"
fail() {
  echo "scaling_test: $1" >&2
  tail -n 30 log ./*.log >&2
  exit 1
}

make_postgres
start_postgres
port=$((19000 + $$ % 700 * 4))
export PGHOST=$work/pg PGUSER=tactus
export DATA=$work/data SHARED=$work/shared
export CATALOG="postgresql:///tactus?host=$work/pg&user=tactus"
export ONE=127.0.0.1:$((port + 1)) TWO=127.0.0.1:$((port + 2)) THREE=127.0.0.1:$((port + 3))
export PATH="$work/bin:$bin:$POSTGRES:$PATH"
mkdir bin

# The flags of a server as the page gives them to the unit of the machine one.
flags=$(awk '/^ExecStart=.*\/tactusd / { on = 1 }
  on { print }
  on && !/\\$/ { exit }' "$source_dir/docs/scaling.md" | tr -d '\\\n')
[[ $flags == *--catalog=*--blobs=*--drain-notice-ms=* ]] ||
  fail "the page has no flags of a server: $flags"
# start-server MACHINE
cat >bin/start-server <<STUB
#!/usr/bin/env bash
set -euo pipefail
cd $work
machine=\$1
mkdir -p "\$machine"
rm -f "\$machine/tactusd.sock"
case "\$machine" in
  before) set -- --listen=$ONE --listen=unix:/run/tactus/tactusd.sock "--data-dir=\$DATA" ;;
  one) set -- ${flags#* } ;;
  two) ONE=$TWO; set -- ${flags#* } ;;
  three) ONE=$THREE; set -- ${flags#* } ;;
esac
# Each machine has the socket of the unit.
tactusd "\${@//\/run\/tactus/$work/\$machine}" --drain-grace-ms=3000 \\
  >>"\$machine.log" 2>&1 </dev/null &
echo "\$!" >"\$machine.pid"
for ((i = 0; i < 400; ++i)); do
  ! tactusd --health-check="unix:$work/\$machine/tactusd.sock" >/dev/null 2>&1 ||
    exit 0
  sleep 0.05
done
cat "\$machine.log"
exit 1
STUB
# systemctl stop|start tactusd, on the machine of $MACHINE; reload tactusd-proxy
cat >bin/systemctl <<STUB
#!/usr/bin/env bash
set -euo pipefail
machine=\${MACHINE:-before}
case "\$1 \$2" in
  'stop tactusd')
    kill -TERM "\$(cat "$work/\$machine.pid")"
    tail --pid="\$(cat "$work/\$machine.pid")" -f /dev/null
    ;;
  'start tactusd') start-server "\$machine" ;;
  'reload tactusd-proxy') start-proxy -sf "\$(cat "$work/proxy.pid")" ;;
esac
STUB
cat >bin/start-proxy <<STUB
#!/usr/bin/env bash
TACTUS_BIND=127.0.0.1 haproxy -D -p "$work/proxy.pid" -f "$work/haproxy.cfg" "\$@"
STUB
# ssh MACHINE COMMAND...
cat >bin/ssh <<STUB
#!/usr/bin/env bash
machine=\$1
shift
MACHINE="\$machine" exec "\${@//\/run\/tactus/$work/\$machine}"
STUB
# mv and sed of the proxy's file, which the page has in /etc.
for program in sed mv; do
  cat >"bin/$program" <<STUB
#!/usr/bin/env bash
exec $(command -v "$program") "\${@//\/etc\/tactus/$work}"
STUB
done
chmod +x bin/*

# section NAME: runs the commands of a section, which must say that it is
# rehearsed.
section() {
  awk -v name="### $1" '
    /^##/ { inside = $0 == name }
    inside && /^\*Rehearsed/ { rehearsed = 1 }
    inside && /^```$/ { code = 0 }
    inside && code { print }
    inside && /^```sh$/ { code = 1 }
    END { exit !rehearsed }' "$source_dir/docs/scaling.md" >commands ||
    fail "the section '$1' is not there, or not marked as rehearsed"
  [[ -s commands ]] || fail "the section '$1' has no commands"
  bash -euxo pipefail commands >log 2>&1 || fail "the commands of '$1' fail"
}

# ------------------------------------------------- one server with data
export TACTUS_SERVER=unix:$work/before/tactusd.sock
trainctl simulate --protocol=grid --skin=good --stiffness 250 1600 --sample=60 \
  --seed=1 --out=a.h5 >/dev/null 2>&1
train=(train --dataset=arm --model=arm --preset=paper --networks=1 --epochs=10
  --seed=3)
sha256() { trainctl models show "$1" --json 2>/dev/null | grep -o '"sha256": *"[^"]*"'; }
fill() {
  trainctl datasets create arm >/dev/null
  trainctl datasets upload arm --data=a.h5 >/dev/null 2>&1
  trainctl models import pads \
    --bundle="$source_dir/server/registry/no-poses.tactus" >/dev/null 2>&1
  trainctl models promote pads@1 >/dev/null
}
# What the training makes where nothing interrupts it.
DATA=$work/alone start-server before
fill
trainctl "${train[@]}" >/dev/null 2>&1
right=$(sha256 arm@1)
systemctl stop tactusd

start-server before
command sed -e "s/:50051\"/:$port\"/" -e "s/127.0.0.1:50052/$ONE/" \
  "$source_dir/deploy/haproxy.cfg" >haproxy.cfg
start-proxy
fill
# With the SHA-256 of the dataset's version, which is that of its trials.
state() {
  trainctl datasets show arm --json && trainctl models show pads@1 --json &&
    trainctl models alias default --json
}
state >before-state

# The right answers, then a robot that goes through all of it.
robot=(tactus-stream --driver=sim --trials=2 --seed=5 --reconnect=120 --json)
"${robot[@]}" --server="$TACTUS_SERVER" --posteriors=right.jsonl >/dev/null 2>&1
trainctl "${train[@]}" --detach >/dev/null
sleep 1
"${robot[@]}" --server="127.0.0.1:$port" --rate=real --posteriors=robot.jsonl \
  >robot.json 2>robot.log &
walker=$!
echo "$walker" >robot.pid
sleep 2

section Prepare
section "Stop and copy"
section "Start three servers"
[[ $(grep -c '^replicas/.*server' log) -eq 3 ]] || fail "not three servers are named"
grep -Eq "^warning  lock .*replicas/" log || fail "the doctor does not see the servers"
grep -q "^ok       blobs" log || fail "the doctor does not check blobs"
export TACTUS_SERVER=unix:$work/two/tactusd.sock
state >after-state
diff before-state after-state || fail "the three servers have other data"
wait "$walker" || fail "the robot fails: $(cat robot.log)"
cmp right.jsonl robot.jsonl || fail "the robot got other answers"
grep -Eq '"resumed": *[1-9]' robot.json || fail "no stream was resumed"

# The training goes on, and ends with the same bundle.
for ((i = 0; i < 600; ++i)); do
  ! sha256 arm@1 >bundle || break
  sleep 0.1
done
[[ $(cat bundle) == "$right" ]] || fail "the training made another bundle: $(cat bundle), not $right"
grep -q 'attempt 2' one.log two.log three.log || fail "the training did not go on"

section "Take a machine out"
state >after-state
diff before-state after-state || fail "the data changed"

section "Go back to one"
DATA=$DATA.new start-server before
export TACTUS_SERVER=unix:$work/before/tactusd.sock
state >back-state
diff before-state back-state || fail "the server has other data than the three"
# This compares each trial with its SHA-256.
trainctl datasets download arm@1 --out=after.h5 >/dev/null ||
  fail "the trials cannot be read"
echo "scaling_test: from one server to three and back, all is there"
