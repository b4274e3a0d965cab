#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Tests of scripts/with_private_lcm: exit codes, arguments and the network it gives.
set -euo pipefail
cd "$(dirname "$0")/../.."
run=scripts/with_private_lcm

fail() { echo "FAILED: $1"; exit 1; }

code=0
"${run}" sh -c 'exit 7' || code=$?
((code == 7)) || fail "exit code ${code} instead of the command's 7"

out="$("${run}" printf '%s|' 'two words' '*')"
[[ "${out}" == 'two words|*|' ]] || fail "arguments arrive as: ${out}"

code=0
"${run}" 2>/dev/null || code=$?
((code == 2)) || fail "no command: exit code ${code} instead of 2"

url="$("${run}" sh -c 'echo "${LCM_DEFAULT_URL}"')"
[[ "${url}" == udpm://*ttl=0* ]] || fail "LCM_DEFAULT_URL is ${url}"

if [[ "$("${run}" sh -c 'echo "${V2VOUCH_PRIVATE_LCM}"')" == namespace ]]; then
  "${run}" ip route get 239.255.76.67 | grep ' dev lo ' >/dev/null || fail "multicast does not go to lo"
  links="$("${run}" ip -o link | wc -l)"
  # Kernels add tunnel devices of their own, all of them down.
  up="$("${run}" ip -o link show up | wc -l)"
  ((up == 1)) || fail "${up} of ${links} links are up instead of lo alone"
  # Inside one, a second call joins the same network.
  "${run}" "${run}" ip route get 239.255.76.67 >/dev/null || fail "nested call"
fi
echo "1 passed, 0 failed"
