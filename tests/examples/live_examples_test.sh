#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Usage (inside scripts/with_private_lcm): live_examples_test.sh BIN_DIR PUBLISHER CONSUMER. The C++
# publisher feeds a daemon; both consumers hear the car ahead.
set -euo pipefail
bin="$1" publisher="$2" consumer="$3"
root="$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)"
work="$(mktemp -d)"
children=()
finish() { kill "${children[@]}" 2>/dev/null || true; wait 2>/dev/null || true; rm -rf "${work}"; }
trap finish EXIT
"${bin}/v2vouchd" 2>"${work}/daemon.txt" & children+=($!)
stdbuf -oL "${consumer}" >"${work}/cpp.txt" & children+=($!)
python3 -u "${root}/examples/python/consume_lists.py" >"${work}/python.txt" & children+=($!)
sleep 1.5
"${publisher}" 4
kill "${children[@]}" 2>/dev/null || true
wait 2>/dev/null || true
grep -q "LOCAL .*x  *3[0-9]\." "${work}/python.txt" || { cat "${work}"/*.txt; echo "no car ahead in Python"; exit 1; }

grep -q "LOCAL .*x  *3[0-9]\." "${work}/cpp.txt" || { cat "${work}"/*.txt; echo "no car ahead in C++"; exit 1; }

echo "live_examples_test: good"
