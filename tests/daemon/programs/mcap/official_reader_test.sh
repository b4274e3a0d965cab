#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Both flavours of a simulated drive through MCAP's own reader (npm @mcap/core), and the raw one back to
# the same bytes. Skipped (77) without node or the packages (scripts/install_npm).
set -euo pipefail
mcap="$1" sim="$2" replay="$3"
here="$(dirname "$0")"

modules="${V2VOUCH_NODE_MODULES:-build/npm/node_modules}"
if ! command -v node >/dev/null; then echo "SKIPPED: no node"; exit 77; fi
if [[ ! -d "${modules}/@mcap/core" || ! -d "${modules}/@foxglove/wasm-zstd" ]]; then
  echo "SKIPPED: no @mcap/core and @foxglove/wasm-zstd in ${modules} (scripts/install_npm)"
  exit 77
fi
export V2VOUCH_NODE_MODULES="$(realpath "${modules}")"

work="$(mktemp -d)"
trap 'rm -rf "${work}"' EXIT
"${sim}" run left_turn --seed 1 --duration 8 --out "${work}/in.lcm" >/dev/null
"${replay}" "${work}/in.lcm" --out "${work}/out.lcm" >/dev/null
for compression in zstd none; do
  "${mcap}" "${work}/out.lcm" --raw --compression "${compression}" --out "${work}/raw.mcap"
  "${mcap}" "${work}/raw.mcap" --out "${work}/back.lcm" >/dev/null
  cmp "${work}/out.lcm" "${work}/back.lcm"
  node "${here}/official_reader.mjs" "${work}/raw.mcap" --all >"${work}/raw.${compression}.json"
done
cmp "${work}/raw.zstd.json" "${work}/raw.none.json" >/dev/null && { echo "zstd makes nothing smaller"; exit 1; }
"${mcap}" "${work}/out.lcm" --out "${work}/view.mcap"
node "${here}/official_reader.mjs" "${work}/view.mcap" --all >"${work}/view.json"
python3 - "${work}" <<'PY'
import json, sys
raw, view = (json.load(open(f"{sys.argv[1]}/{name}.json")) for name in ("raw.zstd", "view"))
assert raw["topics"]["TRACKS_LOCAL"]["encoding"] == "lcm", raw
assert raw["topics"]["TRACKS_LOCAL"]["schemaEncoding"] == "lcmtype", raw
lists = raw["topics"]["TRACKS_LOCAL"]["count"]
assert lists > 200, lists
assert view["topics"]["TRACKS_LOCAL"]["count"] == lists
assert view["topics"]["/v2vouch/local"] == {
    "encoding": "json", "schema": "foxglove.SceneUpdate", "schemaEncoding": "jsonschema", "count": lists}
assert view["topics"]["/ego/gnss"]["schema"] == "foxglove.LocationFix"
assert view["localTracks"] > 0 and view["localTracks"] == view["localCubes"], view
for result in (raw, view):  # Opening reads the summary; seeking the chunk of that moment.
    assert result["opening"]["bytes"] < 100_000 and result["seek"]["messages"] > 10, result
PY
