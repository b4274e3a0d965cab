#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# v2vouch-spy on a bus with a simulated drive and hostile packets: the drive's channels are there with
# their rates, the packets are counted by reason. Inside scripts/with_private_lcm.
set -euo pipefail
spy="$1" sim="$2"
if [[ "${V2VOUCH_PRIVATE_LCM:-}" != namespace ]]; then
  echo "SKIPPED: no private network namespace"
  exit 77
fi
work="$(mktemp -d)"
sender=""
trap 'kill ${sender} 2>/dev/null || true; rm -rf "${work}"' EXIT
python3 - "${work}/begun" <<'PY' &
import pathlib, random, socket, struct, sys, time
random.seed(1)
out = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
out.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 0)
kinds = (b"", b"XXXX" + bytes(20), b"LC02" + bytes(4) + b"N" * 200,
         struct.pack(">4sIIIHH", b"LC03", 1, 1 << 31, 0, 0, 65535) + b"BIG\0" + bytes(100),
         b"LC02" + bytes(4) + b"EVIL\x1b[2J\0" + bytes(range(64)),
         b"LC02" + bytes(4) + b"EGO_MOTION\0" + b"\xff" * 5)
pathlib.Path(sys.argv[1]).touch()
for _ in range(600):
    for kind in kinds:
        out.sendto(kind, ("239.255.76.67", 7667))
    out.sendto(bytes(random.randrange(256) for _ in range(random.randrange(100))), ("239.255.76.67", 7667))
    time.sleep(0.005)
PY
for ((k = 0; k < 300; ++k)); do
  [[ -e "${work}/begun" ]] && break
  sleep 0.1
done
"${sim}" run left_turn --seed 1 --duration 4 --live >/dev/null &
sender=$!
"${spy}" --once --seconds 2.6 --json >"${work}/spy.json"
"${spy}" --once --seconds 0.5 >"${work}/spy.txt" || true
if grep -q $'\x1b' "${work}/spy.txt"; then echo "an escape reached the terminal"; exit 1; fi
python3 - "${work}/spy.json" <<'PY'
import json, sys
report = json.load(open(sys.argv[1]))
rows = {row["channel"]: row for row in report["channels"]}
assert rows["RADAR_FRONT"]["type"] == "radar_scan_t", rows.keys()
assert 15 < rows["RADAR_FRONT"]["rate_hz"] < 25, rows["RADAR_FRONT"]
assert rows["EGO_MOTION"]["refused"]["shorter than a fingerprint"] > 100, rows["EGO_MOTION"]
assert rows["EGO_MOTION"]["lost"] == 0, rows["EGO_MOTION"]
assert len(report["datagrams_refused"]) >= 3, report["datagrams_refused"]
PY
