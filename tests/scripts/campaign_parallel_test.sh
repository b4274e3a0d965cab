#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# A tiny campaign spread over shards by GNU parallel gives the figures of the same campaign in one
# piece, as docs/how-to/run-a-campaign.md says. Usage: campaign_parallel_test.sh V2VOUCH_CAMPAIGN
set -euo pipefail
campaign="$1"
if ! parallel --version 2>/dev/null | grep '^GNU parallel' >/dev/null; then
  echo "SKIPPED: GNU parallel is not installed (package parallel)"
  exit 77
fi
folder="$(mktemp -d)"
trap 'rm -rf "${folder}"' EXIT
export PARALLEL_HOME="${folder}"
touch "${folder}/will-cite"
tiny=(--attacks A8/jump_10m --honest none --scenarios smoke --seeds 2 --json)

"${campaign}" "${tiny[@]}" --out "${folder}/whole" >"${folder}/whole.json"
parallel --jobs 2 "${campaign}" "${tiny[@]}" --shard '{}/3' --out "${folder}/shared" \
  '>' "${folder}/shard{}.json" ::: 1 2 3
"${campaign}" --merge "${folder}/shared" --json >"${folder}/shared.json"

runs="$(find "${folder}/shared/runs" -name '*.json' | wc -l)"
[[ "${runs}" == 4 ]] || { echo "expected 4 runs (2 seeds, attacked and plain), found ${runs}"; exit 1; }
cmp "${folder}/whole.json" "${folder}/shared.json"
echo "4 runs in 3 shards: the same figures"
