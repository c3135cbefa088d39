#!/usr/bin/env bash
# A one-node Slurm cluster of its own (Debian's slurmctld, slurmd and munge) runs a small sweep through deploy/slurm,
# is made to requeue the coordinator and a worker, and must end with the digest of the same sweep in process.
# Usage: slurm_test.sh SOURCE_FOLDER ALOFT
set -euo pipefail
source_folder=$1
export ALOFT=$2
skip() {
  echo "SKIPPED: a sweep through Slurm: $1"
  exit 77
}
for program in slurmctld slurmd sbatch munged; do
  command -v "$program" > /dev/null || PATH=$PATH:/usr/sbin
  command -v "$program" > /dev/null || skip "there is no $program"
done
[ "$(id -u)" -eq 0 ] && unshare --net --pid --fork --mount-proc true 2> /dev/null || skip "a cluster of its own needs root and namespaces"
# Both daemons listen on all interfaces: in a network namespace there is only its own loopback.
if [ -z "${ALOFT_SLURM_NAMESPACE:-}" ]; then
  ALOFT_SLURM_NAMESPACE=1 exec unshare --net --pid --fork --kill-child --mount-proc "$0" "$@"
fi
ip link set lo up
ip address add 10.77.1.1/32 dev lo   # Slurm does not listen where there is nothing but 127.0.0.1

work=$(mktemp -d /tmp/aloft-slurm-XXXXXX)
finish() {
  code=$?
  [ "$code" -eq 0 ] || tail -n 40 "$work"/*.log "$work"/out/log/slurm-*.log 2> /dev/null || true
  rm -rf "$work"
}
trap finish EXIT

mkdir "$work/munge" "$work/state" "$work/spool"
chmod 755 "$work"
chown -R munge "$work/munge"
dd if=/dev/urandom bs=1 count=1024 of="$work/munge/key" status=none
chown munge "$work/munge/key" && chmod 400 "$work/munge/key"
runuser -u munge -- munged --key-file="$work/munge/key" --socket="$work/munge/socket" --pid-file="$work/munge/pid" \
  --log-file="$work/munge/log" --seed-file="$work/munge/seed"
host=$(hostname -s)
cat > "$work/slurm.conf" << CONF
ClusterName=aloft
SlurmctldHost=$host(127.0.0.1)
NodeName=$host NodeAddr=127.0.0.1 CPUs=4 RealMemory=8000
PartitionName=main Nodes=$host Default=YES MaxTime=INFINITE State=UP OverSubscribe=NO
SlurmdParameters=config_overrides
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket=$work/munge/socket
CryptoType=crypto/munge
SlurmctldPort=16817
SlurmdPort=16818
SlurmctldPidFile=$work/slurmctld.pid
SlurmdPidFile=$work/slurmd.pid
StateSaveLocation=$work/state
SlurmdSpoolDir=$work/spool
SlurmctldLogFile=$work/slurmctld.log
SlurmdLogFile=$work/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
MpiDefault=none
ReturnToService=2
KillWait=10
SchedulerParameters=batch_sched_delay=0,sched_interval=1,bf_interval=1,sched_min_interval=0
CONF
export SLURM_CONF=$work/slurm.conf
# Later versions than Debian 12's insist on control groups, which a root of another release does not have.
mountpoint -q /sys/fs/cgroup || echo CgroupPlugin=disabled > "$work/cgroup.conf"
slurmctld
slurmd

# wait_for SECONDS WHAT COMMAND...
wait_for() {
  local limit=$1 what=$2 deadline=$((SECONDS + $1))
  shift 2
  while [ "$SECONDS" -lt "$deadline" ]; do
    if "$@" > /dev/null 2>&1; then return; fi
    sleep 0.2
  done
  echo "waited $limit s for $what" >&2
  squeue >&2 || true
  exit 1
}
idle() { sinfo --noheader --format=%T | grep -qE 'idle|mixed|allocated'; }
wait_for 20 "the cluster" idle

cat > "$work/sweep.json" << JSON
{"name": "sweep", "seed": 3, "trials": 60, "world": {"kind": "generated", "bs_density_per_km2": [1, 5], "steps": 40},
 "agents": ["min-height", "random-walk", {"type": "dqn", "epochs": 40}]}
JSON
export ALOFT_INTERFACE=127.0.0.1
read -r coordinator workers < <("$source_folder/deploy/slurm/submit.sh" "$work/sweep.json" "$work/out" 2)
stored() { "$ALOFT" export "$work/out" --flights --format csv | sed -n 3p | grep -q .; }
wait_for 60 "the first flights" stored

# Requeues the coordinator and a worker: both jobs start again, and the sweep goes on.
scontrol requeue "$coordinator"
scontrol requeue "${workers}_1"
# Slurm would delay them for two minutes; the node needs a moment to notice their end.
sleep 4
ended() {
  for job in "$coordinator" "${workers}_1"; do scontrol update "JobId=$job" StartTime=now || true; done
  ! squeue --noheader --job "$coordinator,$workers" | grep -q .
}
wait_for 400 "the end of the sweep" ended

"$ALOFT" run "$work/sweep.json" --in-process --out "$work/reference" > /dev/null 2>&1
digest=$("$ALOFT" digest "$work/out")
[ "$digest" = "$("$ALOFT" digest "$work/reference")" ] || { echo "another digest: $digest" >&2; exit 1; }
[ -f "$work/out/summary.json" ] || { echo "there is no summary.json" >&2; exit 1; }
# The run was resumed if two coordinators wrote into the log.
[ "$(grep -c "info aloft-coordinator: process" "$work/out/log/aloft-coordinator.log")" -ge 2 ] || { echo "the coordinator was not requeued" >&2; exit 1; }
echo "same digest: $digest"
