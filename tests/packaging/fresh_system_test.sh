#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# From nothing to tracks: a fresh tree of this distribution, the packages put in by apt, a drive simulated,
# replayed and read by the Python consumer, a program of somebody else built, everything purged again without a
# trace. Usage: fresh_system_test.sh FOLDER_OF_PACKAGES [BASE_TREE]; BASE_TREE: a debootstrap tree to copy
# instead of making one. Needs root, debootstrap and a package source.
set -euo pipefail
skip() { echo "SKIPPED: $*"; exit 77; }
fail() { echo "fresh_system_test: $*" >&2; exit 1; }
packages="$(cd "${1:?folder of packages}" && pwd)"
base="${2:-}"
ls "${packages}"/v2vouch_*.deb >/dev/null 2>&1 || skip "no packages in ${packages}: scripts/package makes them"
((EUID == 0)) || skip "chroot is for root only"
if [[ "${3:-}" != --inside ]]; then
  unshare -m true 2>/dev/null || skip "no mount namespace permitted here"
  exec unshare -m "$0" "${packages}" "${base}" --inside
fi
mount --make-rprivate /
tree="$(mktemp -d)"
finish() {
  umount -l "${tree}/proc" "${tree}/dev" 2>/dev/null || true
  rm -rf --one-file-system "${tree}"
}
trap finish EXIT
if [[ -n "${base}" ]]; then
  cp -a "${base}/." "${tree}/"
else
  command -v debootstrap >/dev/null || skip "no debootstrap (package debootstrap)"
  codename="$(. /etc/os-release && echo "${VERSION_CODENAME}")"
  site="$(apt-get indextargets --format '$(CODENAME) $(SITE)' 2>/dev/null |
    awk -v name="${codename}" '$1 == name { print $2; exit }')"
  debootstrap --variant=minbase "${codename}" "${tree}" ${site:+"${site}"} >"${tree}.txt" 2>&1 ||
    { tail -n 3 "${tree}.txt"; rm -f "${tree}.txt"; skip "no package source, or debootstrap cannot run here"; }
  rm -f "${tree}.txt"
fi
mount --bind /dev "${tree}/dev"
mount -t proc none "${tree}/proc"
cp /etc/resolv.conf "${tree}/etc/resolv.conf" 2>/dev/null || true
inside() { chroot "${tree}" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C.UTF-8 \
  DEBIAN_FRONTEND=noninteractive "$@" </dev/null; }
apt() { inside apt-get -q -y -o Dpkg::Use-Pty=0 --no-install-recommends "$@" >"${tree}/root/apt.txt" 2>&1 ||
  { tail -n 20 "${tree}/root/apt.txt"; fail "apt-get $*"; }; }
everything() { (cd "${tree}" && find . -xdev \( -path ./proc -o -path ./dev -o -path ./root -o -path ./tmp -o \
  -path ./var/cache -o -path ./var/log -o -path ./var/lib/apt -o -path ./var/lib/dpkg -o \
  -path ./var/lib/systemd/deb-systemd-helper-enabled \) -prune -o -print | sort); }

inside apt-get -q update >/dev/null 2>&1 || skip "no package source reachable"
mkdir "${tree}/root/debs"
cp "${packages}"/v2vouch*.deb "${tree}/root/debs/"
# What the packages need comes first, as apt chooses it, so that what stays after removal is ours alone.
mapfile -t needs < <(inside bash -c 'apt-get -s --no-install-recommends install /root/debs/*.deb' |
  awk '$1 == "Inst" && $2 !~ /^v2vouch/ { print $2 }')
((${#needs[@]} > 10)) || fail "apt does not say what the packages need"
apt install python3 cmake make g++ pkg-config "${needs[@]}"
everything >"${tree}/root/before.txt"

# The README's own lines, as they stand there, but for the build and the removal.
source="$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)"
sed -n '/^## From a package$/,/^## /{/^```sh$/,/^```$/p}' "${source}/README.md" |
  grep -v -e '^```' -e '^scripts/package' -e '^apt purge' >"${tree}/root/readme.sh"
grep -q consume_lists.py "${tree}/root/readme.sh" || fail "the README's lines on packages are not found"
mkdir -p "${tree}/root/build/package" && ln -s ../../debs "${tree}/root/build/package/packages"
echo 'Apt { Get::Assume-Yes "true"; Install-Recommends "false"; };' >"${tree}/root/apt.conf"
inside env APT_CONFIG=/root/apt.conf bash -euc 'cd /root; . ./readme.sh' >"${tree}/root/said.txt" 2>&1 ||
  { tail -n 20 "${tree}/root/said.txt"; fail "a log to tracks in the Python consumer"; }
grep -q "PRIORITY .*hidden" "${tree}/root/said.txt" || { tail "${tree}/root/said.txt"; fail "no hidden vehicle"; }
echo "the Python consumer: $(grep -c "PRIORITY " "${tree}/root/said.txt") lines of PRIORITY," \
  "$(grep -c "LOCAL " "${tree}/root/said.txt") of LOCAL"

apt install $(cd "${packages}" && ls v2vouch-*.deb | sed 's|^|/root/debs/|')
cp -r "$(dirname "${BASH_SOURCE[0]}")/consumer" "${tree}/root/consumer"
inside bash -euc 'cd /root
  cmake -S consumer -B out && cmake --build out && [ "$(out/types_only)" = good ] && [ "$(out/wire)" = good ]
  g++ -std=c++17 consumer/types_only.cc -o by_pkg_config $(pkg-config --cflags --libs v2vouch)
  [ "$(./by_pkg_config)" = good ]
  PYTHONPATH=/usr/share/v2vouch/python python3 -c "import v2vouch; v2vouch.track_list_t().encode()"
  v2vouch-view --version && man_pages=$(ls /usr/share/man/man[18]/v2vouch*) && [ -n "${man_pages}" ]' >"${tree}/root/said.txt" 2>&1 ||
  { tail -n 20 "${tree}/root/said.txt"; fail "a program of somebody else"; }
mkdir -p "${tree}/var/lib/v2vouch" && touch "${tree}/var/lib/v2vouch/trust.state"  # As after a day of service.

# A folder that Python has put beside the message classes goes too.
ls -d "${tree}"/usr/share/v2vouch/python/v2vouch/__pycache__ >/dev/null || fail "Python keeps no cache here"
apt purge 'v2vouch*'
everything >"${tree}/root/after.txt"
diff "${tree}/root/before.txt" "${tree}/root/after.txt" || fail "removal left or took something"
inside dpkg-query -W 'v2vouch*' 2>/dev/null | grep . && fail "dpkg still knows a package"
echo "fresh_system_test: good ($(. "${tree}/etc/os-release" && echo "${PRETTY_NAME}"))"
