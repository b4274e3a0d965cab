#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# The shipped nftables rules, loaded in a network of this test's own: a datagram from outside is dropped and
# counted, one from this computer arrives. Usage: firewall_test.sh V2VOUCH.NFT
set -euo pipefail
skip() { echo "SKIPPED: $*"; exit 77; }
rules="${1:?rules}"
if [[ "${2:-}" != --inside ]]; then
  command -v nft >/dev/null || skip "no nft (package nftables)"
  for flags in -rn -n; do
    if unshare "${flags}" nft -c -f "${rules}" 2>/dev/null; then exec unshare "${flags}" "$0" "${rules}" --inside; fi
  done
  unshare -rn true 2>/dev/null || unshare -n true 2>/dev/null || skip "no network namespace permitted here"
  unshare -n nft list ruleset >/dev/null 2>&1 || skip "no nftables permitted here"
  echo "firewall_test: the rules are not accepted"
  exit 1
fi
nft -f "${rules}"
ip link set lo up
work="$(mktemp -d)"
unshare -n sleep 60 & stranger=$!
trap 'kill "${stranger}" 2>/dev/null || true; rm -rf "${work}"' EXIT
ip link add outside type veth peer name radio 2>/dev/null || skip "no virtual interfaces permitted here"
ip addr add 10.9.0.1/24 dev outside
ip link set outside up
for ((i = 0; i < 100; ++i)); do  # Until it is in its own network.
  [[ "$(readlink "/proc/${stranger}/ns/net")" != "$(readlink /proc/self/ns/net)" ]] && break
  sleep 0.1
done
ip link set radio netns "${stranger}"
nsenter -t "${stranger}" -n sh -c 'ip addr add 10.9.0.2/24 dev radio; ip link set radio up'
python3 - >"${work}/heard" <<'PY' & listener=$!
import socket
own = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
own.bind(("0.0.0.0", 7667))
own.settimeout(50)
print("listens", flush=True)
while (data := own.recv(100)) != b"from this computer":
    print(data)
print("the end")
PY
for ((i = 0; i < 200; ++i)); do grep -q listens "${work}/heard" && break; sleep 0.1; done
send='import socket, sys
socket.socket(socket.AF_INET, socket.SOCK_DGRAM).sendto(sys.argv[1].encode(), (sys.argv[2], 7667))'
nsenter -t "${stranger}" -n python3 -c "${send}" "from outside" 10.9.0.1
python3 -c "${send}" "from this computer" 127.0.0.1
wait "${listener}" || { echo "firewall_test: this computer is not heard"; exit 1; }
[[ "$(cat "${work}/heard")" == $'listens\nthe end' ]] || { cat "${work}/heard"; echo "a stranger is heard"; exit 1; }
dropped() { nft list table inet v2vouch | grep "dport 7667 .* packets 1 bytes" >/dev/null; }
for ((i = 0; i < 200; ++i)); do dropped && break; sleep 0.1; done  # The counter follows the datagram.
dropped || { nft list table inet v2vouch; echo "firewall_test: a dropped datagram is not counted"; exit 1; }
echo "firewall_test: good"
