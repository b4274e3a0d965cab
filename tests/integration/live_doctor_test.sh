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
seconds=2
fail() { echo "live_doctor_test: $*" >&2; cat "${work}/found.txt" >&2; exit 1; }
# Exit code expected, then words that the answer must have; "!word": must not. A player that a busy
# machine holds up for a second is asked after again.
ask() {
  local try
  for ((try = 0; try < 5; ++try)); do wrong="$(answers "$@")" && return; done
  fail "${wrong}"
}
answers() {
  local expected="$1" code=0 word
  shift
  "${bin}/v2vouch-doctor" --seconds "${seconds}" >"${work}/found.txt" 2>&1 || code=$?
  [[ "${code}" == "${expected}" ]] || { echo "exit code ${code}, not ${expected}"; return 1; }
  for word in "$@"; do
    if [[ "${word}" == !* ]]; then
      ! grep -q -- "${word#!}" "${work}/found.txt" || { echo "says: ${word#!}"; return 1; }
    else
      grep -q -- "${word}" "${work}/found.txt" || { echo "does not say: ${word}"; return 1; }
    fi
  done
}

seconds=1
ask 1 "EGO_MOTION: nothing heard" "RADAR_FRONT: nothing heard" "no v2vouchd" "comes back" "goes by "

seconds=2
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
print("plays", flush=True)
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
until_said() {  # Of a file: a busy machine takes its time to start a program.
  for ((i = 0; i < 300; ++i)); do grep -q "$2" "$1" && return; sleep 0.1; done
  fail "$1 does not come to say $2"
}
play() {
  python3 "${work}/play.py" "${work}/drive.lcm" "$@" >"${work}/plays.txt" & children+=($!)
  player=$!
  until_said "${work}/plays.txt" plays
}
stop_player() { kill "${player}"; wait "${player}" 2>/dev/null || true; }

play
"${bin}/v2vouchd" 2>"${work}/daemon.txt" & children+=($!)
first=$!
until_said "${work}/daemon.txt" event=started
ask 0 "RADAR_FRONT: .* Hz" "one v2vouchd runs" "agrees with EGO_GNSS" '!nothing heard'
"${bin}/v2vouchd" 2>"${work}/second.txt" & children+=($!)
second=$!
until_said "${work}/second.txt" event=started
ask 1 "more than one v2vouchd"
kill "${second}" "${first}"
wait "${second}" "${first}" 2>/dev/null || true
stop_player

seconds=1
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
seconds=0.5  # From here on the network is the question.
# Somebody else holds the port alone.
python3 -c '
import socket, time
s = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
s.bind(("", 7667))
print("bound", flush=True)
time.sleep(30)' >"${work}/bound.txt" & children+=($!)
holder=$!
until_said "${work}/bound.txt" bound
ask 1 "port 7667 cannot be opened" "ss -ulpn"
kill "${holder}"
wait "${holder}" 2>/dev/null || true
# The kernel grants less than was asked for, as a stock one does. (The limit is the whole host's, so this
# process alone is told so.)
cat >"${work}/stock.c" <<'C'
#define _GNU_SOURCE
#include <dlfcn.h>
#include <sys/socket.h>
int setsockopt(int s, int level, int name, const void* value, socklen_t size) {
  static int (*real)(int, int, int, const void*, socklen_t);
  if (!real) real = (int (*)(int, int, int, const void*, socklen_t))dlsym(RTLD_NEXT, "setsockopt");
  const int stock = 212992;
  const int is_buffer = level == SOL_SOCKET && name == SO_RCVBUF;
  return real(s, level, name, is_buffer ? &stock : value, size);
}
C
if cc -shared -fPIC "${work}/stock.c" -o "${work}/stock.so" -ldl 2>/dev/null; then
  LD_PRELOAD="${work}/stock.so" ask 1 "receive buffer of 208 kB instead of" "net.core.rmem_max=8388608"
fi
ask_at() {  # The same of another URL.
  local url="$1"
  shift
  LCM_DEFAULT_URL="${url}" ask "$@"
}
ask_at 'udpm://239.255.76.67:7667?ttl=1' 1 "ttl above 0"
ask_at 'udpm://239.255.76.67:7667?ttl=0&from=10.1.1.1' 1 "is not heard here" "from= in the URL"

if [[ "${V2VOUCH_PRIVATE_LCM:-}" == namespace ]]; then
  if command -v nft >/dev/null && nft add table inet doctor 2>/dev/null; then
    nft add chain inet doctor input '{ type filter hook input priority 0; }'
    nft add rule inet doctor input udp dport 7667 drop
    ask 1 "is not heard here" "nft list ruleset"
    nft delete table inet doctor
  fi
  # An interface without a link (its cable's other end is down), then one without multicast.
  if ip link add sensors type veth peer name switch 2>/dev/null; then
    ip addr add 10.9.0.1/24 dev sensors
    ip link set sensors up
    ip route replace 224.0.0.0/4 dev sensors
    ask 1 "sensors has no link" "cable and switch of sensors"
    ip link set switch up
    ask 1 "goes by sensors" '!has no link'
    ip link set sensors multicast off
    ask 1 "sensors has multicast switched off" "ip link set sensors multicast on"
    ip route replace 224.0.0.0/4 dev lo
  fi
  ip route del 224.0.0.0/4 dev lo
  ask 1 "no route to the group" "ip route add 224.0.0.0/4"
fi
echo "live_doctor_test: good"
