#!/usr/bin/env bash
# A Slurm cluster of one node, this machine, for tests: runs until it is ended.
#
#   tests/cluster/slurm.sh FOLDER &
#   export SLURM_CONF=FOLDER/slurm.conf
#
# The file FOLDER/ready says that it takes jobs. Nothing of it listens to other
# hosts' users: there is no authentication.
set -euo pipefail
folder=${1:?tests/cluster/slurm.sh FOLDER}
export SLURM_CONF=$folder/slurm.conf
mkdir -p "$folder/state" "$folder/spool"
# Ports that other tests do not use.
port=$((27000 + $$ % 500 * 4))
cat >"$SLURM_CONF" <<END
ClusterName=tactus
SlurmctldHost=$(hostname)(127.0.0.1)
SlurmUser=$(id -un)
SlurmdUser=$(id -un)
AuthType=auth/none
CredType=cred/none
# What is requeued waits so long.
AuthInfo=cred_expire=5
SlurmctldPort=$port
SlurmdPort=$((port + 1))
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
MpiDefault=none
ReturnToService=2
SchedulerParameters=batch_sched_delay=0,sched_min_interval=0
KillWait=2
MinJobAge=300
# It has four processors for jobs, however many there are.
SlurmdParameters=config_overrides
NodeName=$(hostname) NodeAddr=127.0.0.1 CPUs=4 State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
END
programs=()
clean_up() {
  scancel --user="$(id -un)" >/dev/null 2>&1 || true
  local pid
  for pid in "${programs[@]}"; do kill -TERM "$pid" 2>/dev/null || true; done
  wait 2>/dev/null || true
}
trap clean_up EXIT
trap 'exit 0' INT TERM
slurmctld -D >"$folder/slurmctld.log" 2>&1 &
programs+=("$!")
slurmd -D >"$folder/slurmd.log" 2>&1 &
programs+=("$!")
is_idle() { sinfo --noheader --format=%T 2>/dev/null | grep -q idle; }
for ((i = 0; i < 600; ++i)); do
  ! is_idle || break
  sleep 0.1
done
is_idle || {
  echo "slurm.sh: no node is ready" >&2
  tail -n 20 "$folder"/slurm*.log >&2
  exit 1
}
touch "$folder/ready"
wait
