#!/bin/bash
# one_node.sh start|stop FOLDER: a Slurm cluster of this machine alone, for tests; needs Debian's slurm-wlm and munge,
# root, and no systemd. `start` prints what to set: export SLURM_CONF=FOLDER/slurm.conf. A node is idle after about a
# second.
set -euo pipefail
command=${1:-} folder=${2:-}
[ -n "$folder" ] || { sed -n '2,3s/^# //p' "$0" >&2; exit 2; }

stop() {
  # Of tasks that still run, the processes that watch them: they hold the port of slurmd.
  local watcher name
  for watcher in $(pgrep slurmstepd || true); do
    if { tr '\0' '\n' < "/proc/$watcher/environ"; } 2> /dev/null |
      grep -qxF "SLURM_CONF=$folder/slurm.conf"; then kill -9 "$watcher" || true; fi
  done
  local pid
  for name in slurmd slurmctld munged; do
    [ -s "$folder/$name.pid" ] || continue
    pid=$(cat "$folder/$name.pid")
    kill "$pid" 2> /dev/null || continue
    # It writes its state before it ends.
    for _ in $(seq 50); do kill -0 "$pid" 2> /dev/null || break; sleep 0.2; done
  done
}

start() {
  mkdir -p "$folder/state" "$folder/spool"
  folder=$(cd "$folder" && pwd -P)
  # munged wants a folder of its own that others cannot write to; --force allows one of any owner.
  mkdir -p "$folder/munge"
  dd if=/dev/urandom of="$folder/munge/key" bs=128 count=1 status=none
  chmod 0700 "$folder/munge/key"
  chmod 0755 "$folder/munge"
  munged --force --key-file="$folder/munge/key" --socket="$folder/munge/socket" --pid-file="$folder/munged.pid" \
    --log-file="$folder/munge/log" --seed-file="$folder/munge/seed"
  local host port memory
  host=$(hostname -s)
  port=${SLURM_TEST_PORT:-16817}
  memory=$(awk '/MemTotal/ { print int($2 / 1024 * 0.9) }' /proc/meminfo)
  cat > "$folder/slurm.conf" << CONF
ClusterName=test
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=$port
SlurmdPort=$((port + 1))
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket=$folder/munge/socket
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.pid
SlurmctldLogFile=$folder/slurmctld.log
SlurmdLogFile=$folder/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
MpiDefault=none
ReturnToService=2
SlurmdTimeout=30
NodeName=$host NodeAddr=127.0.0.1 CPUs=$(nproc) RealMemory=$memory State=UNKNOWN
PartitionName=all Nodes=$host Default=YES MaxTime=INFINITE State=UP
CONF
  export SLURM_CONF=$folder/slurm.conf
  slurmctld -D -i > "$folder/slurmctld.out" 2>&1 &
  slurmd -D > "$folder/slurmd.out" 2>&1 &
  for _ in $(seq 150); do
    timeout 5 sinfo --noheader --format=%t 2> /dev/null |
      grep -q '^idle$' && { echo "export SLURM_CONF=$SLURM_CONF"; return; }
    sleep 0.2
  done
  echo "$0: no idle node; see $folder/slurmctld.log and slurmd.log" >&2
  stop
  exit 1
}

case $command in
  start) start ;;
  stop) stop ;;
  *) sed -n '2,3s/^# //p' "$0" >&2; exit 2 ;;
esac
