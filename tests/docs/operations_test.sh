#!/usr/bin/env bash
# Rehearses docs/operations.md: runs the commands of its sections as they stand
# there, against a server with data, with a stream that goes on across the
# restart. Two simulated contacts in real time make it last some seconds.
#
#   tests/docs/operations_test.sh BUILD_DIR
set -euo pipefail
source_dir=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
work=$(mktemp -d)
clean_up() {
  local children
  mapfile -t children < <(cat "$work"/*.pid 2>/dev/null)
  kill -KILL "${children[@]}" 2>/dev/null || true
  rm -rf "$work"
}
trap clean_up EXIT
cd "$work"
fail() {
  echo "operations_test: $1" >&2
  tail -n 30 log tactusd.log >&2
  exit 1
}

export PATH="$work/bin:$1/bin:$PATH"
export DATA="$work/data" BACKUP="$work/backup" TACTUS_SERVER="unix:$work/s"
mkdir bin
# systemctl stop|start|restart tactusd, for this folder. apt-get has nothing to do.
cat >bin/systemctl <<STUB
#!/usr/bin/env bash
set -euo pipefail
if [[ \$1 != start ]]; then
  kill -TERM "\$(cat $work/tactusd.pid)" 2>/dev/null || true
  tail --pid="\$(cat $work/tactusd.pid)" -f /dev/null
fi
if [[ \$1 != stop ]]; then
  tactusd --listen="$TACTUS_SERVER" --data-dir="$DATA" --drain-grace-ms=500 \
    --log-level=warn >>$work/tactusd.log 2>&1 </dev/null &
  echo "\$!" >$work/tactusd.pid
  for ((i = 0; i < 200; ++i)); do
    ! tactusd --health-check="$TACTUS_SERVER" >/dev/null 2>&1 || exit 0
    sleep 0.05
  done
  exit 1
fi
STUB
printf '#!/bin/sh\n' >bin/apt-get
chmod +x bin/*

# section NAME: runs the commands of a section, which must say that it is
# rehearsed.
section() {
  awk -v name="## $1" '
    /^## / { inside = $0 == name }
    inside && /^\*Rehearsed/ { rehearsed = 1 }
    inside && /^```$/ { code = 0 }
    inside && code { print }
    inside && /^```sh$/ { code = 1 }
    END { exit !rehearsed }' "$source_dir/docs/operations.md" >commands ||
    fail "the section '$1' is not there, or not marked as rehearsed"
  [[ -s commands ]] || fail "the section '$1' has no commands"
  bash -euo pipefail commands >log 2>&1 || fail "the commands of '$1' fail"
}

systemctl start tactusd
trainctl simulate --protocol=random --contacts=4 --skin=good --seed=3 \
  --out=a.h5 >/dev/null 2>&1
trainctl datasets create arm >/dev/null
trainctl datasets upload arm --data=a.h5 >/dev/null 2>&1
trainctl models import arm --bundle="$source_dir/server/registry/no-poses.tactus" \
  >/dev/null
trainctl models promote arm@1 >/dev/null
# With the SHA-256 of the version, which is that of its trials.
state() { trainctl datasets show arm --json && trainctl models list; }
state >before

section Backup
# Twice, because the second one is another.
section Backup

# Everything that came after is gone after a restore, and what was before is
# there.
trainctl datasets create late >/dev/null
kill -KILL "$(cat tactusd.pid)"
tail --pid="$(cat tactusd.pid)" -f /dev/null
rm -r "$DATA/catalog.db" "$DATA/blobs"
section Restore
state >after
diff before after || fail "the restored server has other data"
! trainctl datasets show late >/dev/null 2>&1 ||
  fail "the restored server has what came after the backup"
# This compares each trial with its SHA-256.
trainctl datasets download arm@1 --out=after.h5 >/dev/null ||
  fail "the restored trials cannot be read"

# A stream goes on across the restart.
tactus-stream --server="$TACTUS_SERVER" --driver=sim --trials=2 --rate=real \
  --json >stream.json 2>stream.log &
echo "$!" >stream.pid
for ((i = 0; i < 200; ++i)); do
  streams=$(trainctl server info --json | grep -Eo '"streams": *"?[0-9]+' |
    grep -Eo '[0-9]+$' || true)
  [[ ${streams:-0} == 0 ]] || break
  sleep 0.05
done
section "Upgrade with running streams"
wait "$(cat stream.pid)" || fail "the stream ended: $(cat stream.log)"
grep -Eq '"lost": *0' stream.json || fail "frames were lost"
grep -Eq '"resumed": *[1-9]' stream.json || fail "no stream was resumed"

section Roles
[[ $(trainctl tokens list --file=tokens) == lab* ]] || fail "lab has no token"
! grep -q arm-7 tokens || fail "the removed token is there"

section Certificates
systemctl stop tactusd
tactusd --listen=127.0.0.1:0 --port-file=port --tls-cert=server.crt \
  --tls-key=server.key --log-level=warn >>tactusd.log 2>&1 &
echo "$!" >tls.pid
for ((i = 0; i < 200; ++i)); do
  [[ ! -s port ]] || break
  sleep 0.05
done
tactusd --health-check="localhost:$(cat port)" --tls-ca=authority.crt >log 2>&1 ||
  fail "the certificate is not accepted"
TACTUS_TLS="ssl crt $work/server.pem alpn h2" /usr/sbin/haproxy -c \
  -f "$source_dir/deploy/haproxy.cfg" >log 2>&1 ||
  fail "HAProxy does not take server.pem"
