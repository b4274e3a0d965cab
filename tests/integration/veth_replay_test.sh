#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Captures played with tcpreplay into one end of a pair of virtual interfaces; v2vouch-obu takes them
# at the other end, from a socket and from the interface. Run inside scripts/with_private_lcm.
# Usage: veth_replay_test.sh V2VOUCH-OBU. Exits 77 where something is missing.
set -euo pipefail

skip() { echo "SKIPPED: $1"; exit 77; }

obu="$1"
data="${V2VOUCH_DATA:-../shared/data}/obu/made_here"
command -v tcpreplay >/dev/null || skip "tcpreplay is not installed"
[[ -f "${data}/udp_all_framings.pcap" ]] || skip "no ${data}/udp_all_framings.pcap; set V2VOUCH_DATA"
[[ "${V2VOUCH_PRIVATE_LCM:-}" == namespace ]] || skip "no network namespace permitted here"
ip link add unit0 type veth peer name host0 2>/dev/null || skip "no virtual interfaces permitted here"
ip link set dev host0 address 02:00:00:00:00:02  # The captures' destination.
ip addr add 192.168.88.10/24 dev host0
ip link set unit0 up
ip link set host0 up

work="$(mktemp -d)"
trap 'rm -rf "${work}"' EXIT

# run NAME CAPTURE EXPECTED OPTION...: plays CAPTURE, expects EXPECTED messages published.
run() {
  local name="$1" capture="$2" expected="$3" log="${work}/$1.txt" pid
  shift 3
  "${obu}" "$@" >"${log}" 2>&1 &
  pid=$!
  for _ in $(seq 200); do grep -q event=listening "${log}" && break; sleep 0.05; done
  # 50 a second, a frame at a time: what is tested is the way, not the speed.
  tcpreplay --intf1=unit0 --pps=50 "${capture}" >"${work}/tcpreplay.txt" 2>&1 ||
    { cat "${work}/tcpreplay.txt"; kill -TERM "${pid}"; return 1; }
  sleep 1
  kill -TERM "${pid}"
  wait "${pid}" || { echo "${name}: v2vouch-obu failed"; cat "${log}"; return 1; }
  if ! grep -q "event=stopped.* published=${expected} .*kernel_drops=0" "${log}"; then
    echo "${name}: ${expected} messages expected"
    cat "${log}"
    return 1
  fi
  echo "${name}: ${expected} of ${expected} published"
}

cat >"${work}/two_ports.yaml" <<'YAML'
inputs:
  - {port: 5398, allow: [192.168.88.40]}
  - {port: 7943}
YAML
run sockets "${data}/udp_all_framings.pcap" 12 --config "${work}/two_ports.yaml"
cat >"${work}/interface.yaml" <<'YAML'
inputs:
  - {interface: host0, filter: udp, allow: [192.168.88.40]}
YAML
run interface_udp "${data}/udp_all_framings.pcap" 12 --config "${work}/interface.yaml"
run interface_wsmp "${data}/bsm_signed_wsmp_ethernet.pcap" 120 --interface host0
if "${obu}" --interface nobody0 >"${work}/none.txt" 2>&1; then
  echo "an interface that is not there was opened"
  exit 1
fi
grep -q "interface nobody0: " "${work}/none.txt"

# An interface that goes away (a dongle pulled, a driver restarted) and comes back.
log="${work}/replugged.txt"
"${obu}" --config "${work}/interface.yaml" >"${log}" 2>&1 &
pid=$!
wait_for() { for _ in $(seq 200); do grep -q "$1" "${log}" && return; sleep 0.05; done; cat "${log}"; exit 1; }
wait_for event=listening
ip link del host0
wait_for "event=interface_gone interface=host0"
ip link add unit0 type veth peer name host0
ip link set dev host0 address 02:00:00:00:00:02
ip addr add 192.168.88.10/24 dev host0
ip link set unit0 up
ip link set host0 up
wait_for "event=interface_back interface=host0"
tcpreplay --intf1=unit0 --pps=50 "${data}/udp_all_framings.pcap" >"${work}/tcpreplay.txt" 2>&1
sleep 1
kill -TERM "${pid}"
wait "${pid}" || { echo "replugged: v2vouch-obu failed"; cat "${log}"; exit 1; }
grep -q "event=stopped.* published=12 " "${log}" || { echo "replugged: 12 expected"; cat "${log}"; exit 1; }
echo "replugged: 12 of 12 published"
