#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Usage: installed_test.sh BUILD_DIR. Installs into a fresh prefix, hides source and build tree from
# what follows (a mount namespace with empty folders over them), runs the programs from there, builds a
# program of somebody else with find_package and pkg-config, and removes everything again.
set -euo pipefail
build="$(cd "$1" && pwd)"
source="$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)"
fail() { echo "installed_test: $*" >&2; exit 1; }

if [[ "${2:-}" != --inside ]]; then
  flags=(-m)
  if ! unshare -m true 2>/dev/null; then
    flags=(-rm)
    unshare -rm true 2>/dev/null || { echo "SKIPPED: no mount namespace permitted here"; exit 77; }
  fi
  place="$(mktemp -d)"
  trap 'rm -rf "${place}"' EXIT
  # A path that cannot be known at build time, with a space in it.
  DESTDIR="${place}" cmake --install "${build}" --prefix "/some where" >"${place}/install.txt" ||
    fail "cmake --install"
  sed '$a\' "${build}/install_manifest.txt" >"${place}/manifest.txt"  # Ends without a newline.
  mkdir "${place}/work"
  cp "${source}/tests/packaging/consumer/"* "${place}/work/"
  cp -r "${source}/examples" "${place}/work/"
  cp "${BASH_SOURCE[0]}" "${place}/test.sh"
  unshare "${flags[@]}" bash -c '
    mount -t tmpfs none "$1" || exit 77
    if [[ -d "$2" ]]; then mount -t tmpfs none "$2"; fi
    exec bash "$3" "$4" --inside' - "${source}" "${build}" "${place}/test.sh" "${place}" || exit $?
  # Removed without a trace by its manifest.
  while read -r file; do rm -- "${place}${file}"; done <"${place}/manifest.txt"
  if find "${place}/some where" ! -type d | grep .; then fail "files are left"; fi
  echo "installed_test: good"
  exit 0
fi

place="${build}"  # Inside: the first argument is the place.
prefix="${place}/some where"
cd "${place}/work"
export PATH="${prefix}/bin:${PATH}"
unset V2VOUCH_SHARE
count=0
for program in "${prefix}"/bin/*; do
  words="$("${program}" --version)" || fail "${program} --version"
  [[ "${words}" == "$(basename "${program}") "* ]] || fail "--version says ${words}"
  ((count += 1))
done
((count >= 14)) || fail "only ${count} programs are installed"

v2vouch-sim list >list.txt
grep -q left_turn list.txt || fail "shipped scenarios are not found"
v2vouch-sim run left_turn --seed 1 --duration 4 --with A5/lateral_8m --out drive.lcm >/dev/null 2>/dev/null ||
  fail "v2vouch-sim run, with a shipped attack"
v2vouch-replay drive.lcm --config "${prefix}/share/v2vouch/config/vehicle.yaml" --out tracks.lcm \
  >/dev/null || fail "v2vouch-replay"
v2vouch-eval tracks.lcm --report report >/dev/null 2>&1 || fail "v2vouch-eval"

# Man page and completions of every program, with every option of --help in them.
for program in "${prefix}"/bin/*; do
  name="$(basename "${program}")"
  page="$(ls "${prefix}"/share/man/man[18]/"${name}".[18].gz)" || fail "no man page of ${name}"
  text="$(zcat "${page}" | sed 's/\\-/-/g')"
  completion="${prefix}/share/bash-completion/completions/${name}"
  bash -n "${completion}" || fail "bash completion of ${name}"
  head -1 "${prefix}/share/zsh/vendor-completions/_${name}" | grep "^#compdef ${name}$" >/dev/null ||
    fail "zsh completion of ${name}"
  if command -v zsh >/dev/null; then zsh -n "${prefix}/share/zsh/vendor-completions/_${name}"; fi
  while read -r option; do
    grep -qF -- "${option}" <<<"${text}" || fail "${option} is not in the man page of ${name}"
    grep -qF -- "${option}" "${completion}" || fail "${option} is not completed for ${name}"
  done < <("${program}" --help | grep -oE '^  [^ ]*--[a-z0-9-]+' | grep -oE -- '--[a-z0-9-]+')
done
complete_words() {  # Of a command line, as bash would offer them.
  local -a COMP_WORDS=("$@") COMPREPLY=()
  local COMP_CWORD=$(($# - 1))
  source "${prefix}/share/bash-completion/completions/$1"
  "_${1//-/_}"
  echo "${COMPREPLY[*]}"
}
[[ "$(complete_words v2vouch-sim r)" == run ]] || fail "completion of a subcommand"
[[ "$(complete_words v2vouch-sim run --vehicle)" == --vehicle-out ]] || fail "its options"
unit="$(find "${prefix}" -name v2vouchd.service)"
for line in Type=notify WatchdogSec=2 DynamicUser=yes ProtectSystem=strict; do
  grep -qx "${line}" "${unit}" || fail "${line} is not in the unit"
done
if command -v systemd-analyze >/dev/null; then
  sed "s|^ExecStart=[^ ]*|ExecStart=/bin/true|" "${unit}" >v2vouchd.service
  systemd-analyze verify --man=no ./v2vouchd.service || fail "systemd-analyze verify"
fi

# Somebody else's program, three ways.
cmake -S . -B cmake_build -DCMAKE_PREFIX_PATH="${prefix}" >cmake.txt 2>&1 ||
  { cat cmake.txt; fail "find_package(v2vouch)"; }
cmake --build cmake_build >cmake.txt 2>&1 || { cat cmake.txt; fail "build by find_package"; }
library="$(dirname "$(find "${prefix}" -name v2vouch.pc)")"
export PKG_CONFIG_PATH="${library}"
eval "g++ -std=c++17 types_only.cc -o by_pkg_config $(pkg-config --cflags --libs v2vouch)" ||
  fail "pkg-config v2vouch"
cmake -S examples/cpp -B examples_build -DCMAKE_PREFIX_PATH="${prefix}" >cmake.txt 2>&1 &&
  cmake --build examples_build >>cmake.txt 2>&1 || { cat cmake.txt; fail "examples by find_package"; }
examples_build/consume_lists "file://tracks.lcm?speed=0" >consumer.txt && grep -q "LOCAL " consumer.txt ||
  fail "C++ consumer of a log"
# The Python consumer as it is installed: nothing but Python, no lcm-gen.
mkdir without
printf '#!/bin/sh\nexit 1\n' >without/lcm-gen
chmod +x without/lcm-gen
PATH="${place}/work/without:${PATH}" env -u PYTHONDONTWRITEBYTECODE python3 "${prefix}/share/doc/v2vouch/examples/python/consume_lists.py" \
  tracks.lcm >consumer.txt &&
  grep -q "LOCAL " consumer.txt || fail "Python consumer of a log"
# Beside the example that was run Python may keep a cache; beside the message classes the reader sees that it does not.
rm -rf "${prefix}/share/doc/v2vouch/examples/python/__pycache__"
[[ -z "$(find "${prefix}" -name __pycache__)" ]] || fail "Python has left something behind"
for program in cmake_build/types_only cmake_build/wire ./by_pkg_config; do
  [[ "$("${program}")" == good ]] || fail "${program}"
done
eval "ls $(pkg-config --variable=lcmtypes v2vouch)/track_list_t.lcm" >/dev/null || fail "lcmtypes in v2vouch.pc"
