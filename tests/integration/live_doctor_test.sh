#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Usage (inside scripts/with_private_lcm): live_doctor_test.sh BIN_DIR. What v2vouch-doctor says of
# set-ups with one thing wrong each.
set -euo pipefail
bin="$1"
work="$(mktemp -d)"
children=()
finish() {
  if ((${#children[@]})); then kill "${children[@]}" 2>/dev/null || true; fi
  wait 2>/dev/null || true
  rm -rf "${work}"
}
trap finish EXIT
fail() { echo "live_doctor_test: $*" >&2; cat "${work}/found.txt" >&2; exit 1; }
ask() {  # Exit code expected, then words that the answer must have; "!word": must not.
  local expected="$1" code=0 word
  shift
  "${bin}/v2vouch-doctor" --seconds 2 >"${work}/found.txt" 2>&1 || code=$?
  [[ "${code}" == "${expected}" ]] || fail "exit code ${code}, not ${expected}"
  for word in "$@"; do
    if [[ "${word}" == !* ]]; then
      ! grep -q -- "${word#!}" "${work}/found.txt" || fail "says: ${word#!}"
    else
      grep -q -- "${word}" "${work}/found.txt" || fail "does not say: ${word}"
    fi
  done
}

ask 1 "EGO_MOTION: nothing heard" "RADAR_FRONT: nothing heard" "no v2vouchd" "comes back" "goes by "

# A drive in time with this computer, under a right and a wrong name, with a wrong type, at a wrong time.
"${bin}/v2vouch-sim" run left_turn --seed 1 --duration 3 --out "${work}/drive.lcm" >/dev/null 2>&1
cat >"${work}/play.py" <<'PY'
import socket, struct, sys, time
events, rename, shift = [], dict(a.split("=") for a in sys.argv[2:] if "=" in a), {}
for a in sys.argv[2:]:
    if ":" in a:
        shift[a.split(":")[0]] = int(float(a.split(":")[1]) * 1e6)
data = open(sys.argv[1], "rb").read()
at = 0
while at + 28 <= len(data):
    _, _, utime, n, m = struct.unpack(">IqqII", data[at:at + 28])
    events.append((utime, data[at + 28:at + 28 + n].decode(), data[at + 28 + n:at + 28 + n + m]))
    at += 28 + n + m
sock = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
seq = 0
while True:
    start, t0 = time.time(), events[0][0]
    for utime, channel, body in events:
        time.sleep(max(0, start + (utime - t0) * 1e-6 - time.time()))
        if channel.startswith(("TRUTH", "SIM")):
            continue
        (stamp,) = struct.unpack(">q", body[8:16])
        stamp += int(start * 1e6) - t0 + shift.get(channel, 0)
        body = body[:8] + struct.pack(">q", stamp) + body[16:]
        name = rename.get(channel, channel)
        sock.sendto(struct.pack(">II", 0x4C433032, seq) + name.encode() + b"\0" + body, ("239.255.76.67", 7667))
        seq += 1
PY
play() { python3 "${work}/play.py" "${work}/drive.lcm" "$@" & children+=($!); player=$!; sleep 0.3; }
stop_player() { kill "${player}"; wait "${player}" 2>/dev/null || true; }

play
"${bin}/v2vouchd" 2>"${work}/daemon.txt" & children+=($!)
first=$!
sleep 1
ask 0 "RADAR_FRONT: .* Hz" "one v2vouchd runs" "agrees with EGO_GNSS" '!nothing heard'
"${bin}/v2vouchd" 2>/dev/null & children+=($!)
second=$!
sleep 1.2
ask 1 "more than one v2vouchd"
kill "${second}" "${first}"
wait "${second}" "${first}" 2>/dev/null || true
stop_player

play RADAR_FRONT=RADAR_FORNT CAMERA_FRONT=EGO_MOTION
ask 1 "RADAR_FRONT: nothing heard.*RADAR_FORNT" "RADAR_FORNT.*did you mean RADAR_FRONT" \
  "EGO_MOTION: .*refused"
stop_player
play EGO_GNSS:18 RADAR_FRONT:18
ask 1 "GPS time instead of UTC"
stop_player

"${bin}/v2vouch-doctor" --seconds 0.5 --json >"${work}/found.txt" && fail "good without input"
python3 - "${work}/found.txt" <<'PY'
import json, sys
found = json.load(open(sys.argv[1]))
assert found["good"] is False
assert {"check", "state", "text", "advice"} == set(found["findings"][0])
PY
# Somebody else holds the port alone.
python3 -c '
import socket, time
s = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
s.bind(("", 7667))
print("bound", flush=True)
time.sleep(30)' >"${work}/bound.txt" & children+=($!)
holder=$!
for ((i = 0; i < 100; ++i)); do [[ -s "${work}/bound.txt" ]] && break; sleep 0.1; done
ask 1 "port 7667 cannot be opened" "ss -ulpn"
kill "${holder}"
wait "${holder}" 2>/dev/null || true
if [[ "${V2VOUCH_PRIVATE_LCM:-}" == namespace ]]; then
  ip route del 224.0.0.0/4 dev lo
  ask 1 "no route to the group" "ip route add 224.0.0.0/4"
fi
echo "live_doctor_test: good"
