#!/usr/bin/env bash
# tactus-stream with a skin on a moving arm, as docs/drivers.md shows it: the
# skin on a pseudo-terminal and the joint values by UDP, both from
# moving_arm.py, in real time. The places of the contacts must be those that
# moving_arm.py computes, within 15 mm, and a replay of the recording must give
# the same answers.
#
#   tests/tools/stream/arm_stream_check.sh BUILD_FOLDER
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
bin=$1/bin
work=$(mktemp -d)
pids=()
stop() {
  if [[ ${#pids[@]} -gt 0 ]]; then
    kill "${pids[@]}" 2>/dev/null || true
    wait "${pids[@]}" 2>/dev/null || true
  fi
  rm -rf "$work"
}
trap stop EXIT

"$bin/tactusd" --listen="unix:$work/socket" --log-level=warn &
pids+=($!)
for ((i = 0; i < 600; i++)); do
  [[ -S $work/socket ]] && break
  sleep 0.1
done
# A port that is free now.
port=$(/usr/bin/python3 -c 'import socket
s = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
s.bind(("127.0.0.1", 0))
print(s.getsockname()[1])')
/usr/bin/python3 "$here/moving_arm.py" "127.0.0.1:$port" 16 >"$work/arm.txt" &
pids+=($!)
for ((i = 0; i < 600; i++)); do
  [[ -s $work/arm.txt ]] && break
  sleep 0.1
done
echo '{"layout": "cody-forearm"}' >"$work/cody.json"
"$bin/tactus-stream" --server="unix:$work/socket" --driver=serial \
  --port="$(head -n 1 "$work/arm.txt")" --format=ascii --rate-hz=100 \
  --layout="$work/cody.json" --scale=0.01 \
  --urdf="$here/../../golden/kinematics/scara.urdf" --skin-link=skin \
  --joints="127.0.0.1:$port" --seconds=15 --json --record="$work/arm.mcap" \
  >"$work/stream.json"
# Poses, and answers, are in the recording.
"$bin/tactus-stream" --server="unix:$work/socket" --driver=replay \
  --data="$work/arm.mcap" | tail -n 1 | tee "$work/replay.txt"
grep -Eq '^([0-9]+) of \1 answers equal' "$work/replay.txt"

/usr/bin/python3 - "$work/arm.txt" "$work/stream.json" <<'CHECK'
import json
import math
import sys

touches = [list(map(float, line.split()[1:]))
           for line in open(sys.argv[1]) if line.startswith("touch")]
lines = [json.loads(line) for line in open(sys.argv[2])]
contacts = [line for line in lines if "contact" in line]
places = [c["place_m"] for c in contacts if "place_m" in c]
end = lines[-1]
print("touches", len(touches), "contacts", len(contacts), "frames",
      end["frames"], "without pose", end["without_pose"])
far = 0
for place in places:
    near = min(math.dist(place, touch) for touch in touches)
    print("place", place, "%.1f mm from the touch" % (1e3 * near))
    far = max(far, near)
sys.exit(not (len(places) >= 2 and len(places) == len(contacts)
              and far < 0.015))
CHECK
