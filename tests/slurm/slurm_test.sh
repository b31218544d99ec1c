#!/bin/bash
# A campaign through a real Slurm: submitted as a job array, a worker killed, a task killed, its node down and up again,
# submitted anew; the merged files are those of a local run, byte by byte. SCREED_PROGRAM names the program under test.
set -euo pipefail
root=$(cd "$(dirname "$0")/../.." && pwd -P)

for program in slurmctld slurmd sbatch munged; do
  PATH=$PATH:/usr/sbin command -v $program > /dev/null \
    || { echo "$program is not installed: apt install slurm-wlm munge"; exit 77; }
done
[ "$(id -u)" = 0 ] || { echo "a Slurm of its own needs root"; exit 77; }
export PATH=$PATH:/usr/sbin

work=$(mktemp -d)
finish() {
  "$root/tools/slurm/one_node.sh" stop "$work/slurm"
  wait
  rm -rf "$work"
}
trap finish EXIT
fail() { echo "FAILED: $*"; tail -n 5 "$work"/out/slurm/slurm/*/*.log "$work"/slurm/*.log 2> /dev/null; exit 1; }

cd "$work"
# 60 runs of some milliseconds, and 8 long enough to be met by a kill.
printf '[map]\nmodel = rigid\nsize = 1\nedges = walls\n[experiment]\nduration = 0.3\n' > flat.ini
cat > slurm.ini << 'CAMPAIGN'
[campaign]
experiment = flat.ini
seeds = 1..34
shard = 17
retries = 2
[grid]
experiment.duration = 0.3, 60
CAMPAIGN
screed=$SCREED_PROGRAM
"$screed" campaign run slurm.ini --out local --quiet > /dev/null
"$screed" campaign merge local > /dev/null

eval "$("$root/tools/slurm/one_node.sh" start "$work/slurm")"
submit() { "$screed" campaign submit slurm.ini --slurm > submitted || fail "campaign submit";
  grep -oP 'job \K[0-9]+' submitted || true; }
results() { cat out/slurm/results/*.jsonl 2> /dev/null | wc -l; }
wait_for_results() { until [ "$(results)" -ge "$1" ]; do squeue --noheader | grep -q . ||
  fail "no job and $(results) results"; sleep 0.1; done; }
wait_for_end() { while squeue --noheader --jobs="$1" 2> /dev/null | grep -q .; do sleep 0.2; done; }
pids() { pgrep -f -- "$1" || true; }  # of this test's folder alone

job=$(submit)
[ -n "$job" ] || fail "no job: $(cat submitted)"
grep -q "68 runs in 4 tasks" submitted || fail "$(cat submitted)"

# A second submission would run the same twice.
if "$screed" campaign submit slurm.ini --slurm > again 2>&1; then fail "submitted while job $job is in the queue"; fi
grep -q "job $job of this campaign has" again || fail "$(cat again)"

# A worker is killed: its run is tried again within the task.
wait_for_results 4
kill -9 $(pids "campaign worker $work/out/slurm" | head -n 1)

# The node is lost and comes back: its tasks are queued again, and do what is missing of them.
wait_for_results 12
node=$(hostname -s)
scontrol update nodename="$node" state=down reason=test
# It may have come back by itself: slurmd registers it anew.
until sinfo --noheader --nodes="$node" --format=%t | grep -qE '^(idle|mix|alloc)$'; do
  scontrol update nodename="$node" state=resume 2> /dev/null || true
  sleep 0.2
done
# Slurm lets tasks of a lost node wait for two minutes.
for task in $(squeue --noheader --array --format=%i --jobs="$job"); do
  scontrol update jobid="$task" starttime=now 2> /dev/null || true; done

# A whole task is killed: it fails, and its runs are missing.
before=$(results)
wait_for_results $((before + 4))
kill -9 $(pids "campaign run $work/out/slurm" | head -n 1)
wait_for_end "$job"
"$screed" campaign status out/slurm > status
grep -q missing status || fail "nothing is missing after a task was killed: $(cat status)"

# Submitted again: only what is missing.
job=$(submit)
[ -n "$job" ] || fail "no second job: $(cat submitted)"
if grep -q " 68 runs" submitted; then fail "finished runs were submitted again: $(cat submitted)"; fi
wait_for_end "$job"
"$screed" campaign submit slurm.ini --slurm | grep -q "complete: 68 runs; nothing to submit" ||
  fail "not complete: $("$screed" campaign status out/slurm)"
"$screed" campaign merge out/slurm > /dev/null || fail "campaign merge"
cmp local/runs.csv out/slurm/runs.csv
cmp local/campaign.h5 out/slurm/campaign.h5
echo "68 runs through $(sinfo --version): a worker, a node and a task killed, submitted again;" \
  "merged like a local run, byte by byte"
