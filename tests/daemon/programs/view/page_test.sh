#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Runs page_test.js where everything for it is there; exit code 77 and the reason where not.
# Usage: page_test.sh PROGRAMS. Packages: scripts/install_npm.
set -euo pipefail
root="$(cd "$(dirname "${BASH_SOURCE[0]}")/../../../.." && pwd)"
modules="${V2VOUCH_NPM:-${root}/build/npm}/node_modules"
skip() { echo "SKIPPED: $1"; exit 77; }
command -v node >/dev/null || skip "no node"
[[ -x "${CHROMIUM:-/usr/bin/chromium}" ]] || skip "no Chromium"
for package in puppeteer-core @foxglove/ws-protocol ws; do
  [[ -d "${modules}/${package}" ]] || skip "no npm package ${package} (scripts/install_npm)"
done
for program in v2vouchd v2vouch-sim v2vouch-replay v2vouch-eval v2vouch-view; do
  [[ -x "$1/${program}" ]] || skip "no ${program}"
done
"${root}/scripts/with_private_lcm" true 2>/dev/null || skip "no network namespace"
scratch="$(mktemp -d)"
trap 'rm -rf "${scratch}"' EXIT
NODE_PATH="${modules}" HOME="${scratch}" timeout 170 \
  "${root}/scripts/with_private_lcm" node "${root}/tests/daemon/programs/view/page_test.js" "$1" "${scratch}"
