#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# scripts/fetch_yolov4 without any network: a stand-in for curl gives what each case needs.
set -euo pipefail
folder="$(mktemp -d)"
trap 'rm -rf "${folder}"' EXIT
fetch=scripts/fetch_yolov4

# expect CODE TEXT command...: exit code, and TEXT somewhere in what it says.
expect() {
  local code="$1" text="$2" output status=0
  shift 2
  output="$("$@" 2>&1)" || status=$?
  if [[ "${status}" != "${code}" || "${output}" != *"${text}"* ]]; then
    printf 'FAILED: %s\nexit code %s, wanted %s; wanted "%s" in:\n%s\n' "$*" "${status}" "${code}" \
      "${text}" "${output}"
    exit 1
  fi
}

mkdir "${folder}/bin"
# What curl does: exit code, and bytes for --output FILE (the seventh argument).
stand_in() {
  printf '#!/bin/sh\nwhile [ "$1" != --output ]; do shift; done\nprintf "%s" > "$2"\nexit %s\n' \
    "$2" "$1" >"${folder}/bin/curl"
  chmod +x "${folder}/bin/curl"
}
export PATH="${folder}/bin:${PATH}"

expect 0 "Usage" "${fetch}" --help
expect 2 "unknown option --huge" "${fetch}" --huge
expect 2 "--dir needs a folder" "${fetch}" --dir
expect 1 "yolov4-tiny.weights: not there" "${fetch}" --check --dir "${folder}/none"

stand_in 6 ""
expect 1 "Is there a network?" "${fetch}" --dir "${folder}/a"
expect 1 "releases/download/darknet_yolo_v3_optimal/yolov4.weights" "${fetch}" --full --dir "${folder}/a"

stand_in 0 "an error page"
expect 1 "has 13 bytes, the official file has 24251276" "${fetch}" --dir "${folder}/b"
if [[ -n "$(ls -A "${folder}/b")" ]]; then echo "FAILED: a wrong file was kept"; exit 1; fi

head -c 3231 /dev/zero >"${folder}/b/yolov4-tiny.cfg"
expect 1 "SHA-256 is" "${fetch}" --check --dir "${folder}/b"

# The real .cfg, where the reference data is.
models="${V2VOUCH_DATA:-../shared/data}/models"
if [[ -d "${models}" ]]; then
  expect 1 "yolov4-tiny.cfg: right" "${fetch}" --check --dir "${models}"
  expect 1 "yolov4.cfg: right" "${fetch}" --full --check --dir "${models}"
fi
echo "all good"
