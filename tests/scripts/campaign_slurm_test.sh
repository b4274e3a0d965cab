#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# A tiny campaign as an array job of a real one-node Slurm, on loopback in a network of its own: the same
# figures as in one process, and an ended task is taken up again. Usage: campaign_slurm_test.sh CAMPAIGN
set -euo pipefail
campaign="$1"
root="$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)"
skip() { echo "SKIPPED: $*"; exit 77; }
for tool in slurmctld slurmd sbatch munged; do
  command -v "${tool}" >/dev/null || skip "no ${tool} (packages slurmctld slurmd slurm-client munge)"
done
((EUID == 0)) || skip "slurmd runs as root only"
# Ports and host name of its own: nothing of this test is seen from outside.
if [[ "${2:-}" != --inside ]]; then
  unshare -nmu true 2>/dev/null || skip "no namespaces permitted here"
  exec unshare -nmu "$0" "${campaign}" --inside
fi
ip link set lo up
ip addr add 10.99.0.1/32 dev lo  # Slurm asks for an address family, which loopback alone does not count as.
hostname v2vouchtest
work="$(mktemp -d)"
children=()
finish() {
  if ((${#children[@]})); then
    kill "${children[@]}" 2>/dev/null || true
    sleep 1
    kill -KILL "${children[@]}" 2>/dev/null || true
    wait "${children[@]}" 2>/dev/null || true
  fi
  rm -rf "${work}"
}
trap finish EXIT
echo "127.0.0.1 localhost v2vouchtest" >"${work}/hosts"
mount --bind "${work}/hosts" /etc/hosts
chmod 755 "${work}"
mkdir -m 755 "${work}/state" "${work}/spool" "${work}/munge"
dd if=/dev/urandom of="${work}/munge/key" bs=64 count=1 status=none
chmod 400 "${work}/munge/key"
# munged's socket is where libmunge looks unless told otherwise: told in slurm.conf.
munged --foreground --force --key-file="${work}/munge/key" --socket="${work}/munge/socket" \
  --pid-file="${work}/munge/pid" --log-file="${work}/munge/log" --seed-file="${work}/munge/seed" \
  2>"${work}/munged.txt" & children+=($!)
cat >"${work}/slurm.conf" <<CONF
ClusterName=test
SlurmctldHost=v2vouchtest(127.0.0.1)
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket=${work}/munge/socket
CredType=cred/munge
SlurmctldPort=16817
SlurmdPort=16818
StateSaveLocation=${work}/state
SlurmdSpoolDir=${work}/spool
SlurmctldPidFile=${work}/slurmctld.pid
SlurmdPidFile=${work}/slurmd.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
ReturnToService=2
SchedulerParameters=batch_sched_delay=0,sched_interval=1
SelectType=select/cons_tres
NodeName=v2vouchtest NodeAddr=127.0.0.1 CPUs=2 State=UNKNOWN
PartitionName=all Nodes=v2vouchtest Default=YES State=UP MaxTime=10
CONF
export SLURM_CONF="${work}/slurm.conf"
for ((i = 0; i < 50; ++i)); do [[ -S "${work}/munge/socket" ]] && break; sleep 0.1; done
slurmctld -D -f "${SLURM_CONF}" >"${work}/slurmctld.txt" 2>&1 & children+=($!)
slurmd -D -f "${SLURM_CONF}" -N v2vouchtest >"${work}/slurmd.txt" 2>&1 & children+=($!)
for ((i = 0; i < 100; ++i)); do
  sinfo --noheader -o %t 2>/dev/null | grep idle >/dev/null && break
  sleep 0.2
done
if ! sinfo --noheader -o %t 2>/dev/null | grep idle >/dev/null; then
  tail -n 8 "${work}"/*.txt "${work}/munge/log" >&2 || true
  skip "slurmd cannot run here"
fi

tiny=(--attacks A8/jump_10m --honest none --scenarios smoke --seeds 2 --json)
"${campaign}" "${tiny[@]}" --out "${work}/whole" >"${work}/whole.json" 2>/dev/null
export V2VOUCH_CAMPAIGN="${campaign}"
"${root}/scripts/campaign_slurm" 2 "${work}/array" "${tiny[@]}" >"${work}/array.json" ||
  { cat "${work}"/array/slurm-*.txt; exit 1; }
cmp "${work}/whole.json" "${work}/array.json"

# A task that is ended on its way (scancel, as a time limit or a lost node would): told, and the same call runs
# what is missing, that alone.
more=(--attacks A8/jump_10m --honest none --scenarios smoke --seeds 8 --json)
"${campaign}" "${more[@]}" --out "${work}/whole8" >"${work}/whole8.json" 2>/dev/null
code=0
"${root}/scripts/campaign_slurm" 2 "${work}/array8" "${more[@]}" >"${work}/ended.json" 2>"${work}/ended.txt" & submitted=$!
finished() { find "${work}/array8/runs" -name '*.json' 2>/dev/null | wc -l; }
for ((i = 0; i < 600; ++i)); do (($(finished) >= 2)) && break; sleep 0.1; done
scancel --name=v2vouch-campaign
wait "${submitted}" || code=$?
left="$(finished)"
((left < 16)) || { echo "all 16 runs were through before a task could be ended"; exit 1; }
((code == 1)) && grep -q "a task failed" "${work}/ended.txt" ||
  { cat "${work}/ended.txt"; echo "an ended task was not told: exit code ${code}"; exit 1; }
touch "${work}/mark"
"${root}/scripts/campaign_slurm" 2 "${work}/array8" "${more[@]}" >"${work}/again.json"
cmp "${work}/whole8.json" "${work}/again.json"
anew="$(find "${work}/array8/runs" -name '*.json' -newer "${work}/mark" | wc -l)"
((anew == 16 - left)) || { echo "${anew} runs were run, $((16 - left)) were missing"; exit 1; }
echo "an array of 2 tasks: the same figures; ended after ${left} of 16 runs, the same call did the other ${anew}"
