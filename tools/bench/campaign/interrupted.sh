#!/bin/bash
# interrupted.sh SCREED RUNS KILLS FOLDER: a campaign of short runs on rigid ground, once undisturbed and once killed so
# often, and whether the merged files are equal. Every other kill is of a worker, the others of the whole campaign.
# Makes the figures of docs/studies/campaigns.md.
set -euo pipefail
screed=$1 runs=$2 kills=$3 folder=$4
mkdir -p "$folder"
cd "$folder"
printf '[map]\nmodel = rigid\nsize = 1\n[experiment]\nduration = 0.3\n' > flat.ini
printf '[campaign]\nexperiment = flat.ini\nseeds = 1..%d\n[grid]\nvehicle.h = 0, 30, 60, 90\n' $((runs / 4)) > short.ini

results() { cat "$1"/results/*.jsonl 2> /dev/null | wc -l; }
children() { ps -o pid= --ppid "$1" 2> /dev/null || true; }

time "$screed" campaign run short.ini --out whole --quiet
killed=0
while [ "$killed" -lt "$kills" ]; do
  "$screed" campaign run short.ini --out killed --quiet > /dev/null 2>&1 &
  campaign=$!
  while [ "$killed" -lt "$kills" ]; do
    goal=$(((killed + 1) * runs / (kills + 1)))
    while [ "$(results killed)" -lt "$goal" ] && kill -0 "$campaign" 2> /dev/null; do sleep 0.2; done
    killed=$((killed + 1))
    worker=$(children "$campaign" | shuf -n 1)
    if [ $((killed % 2)) = 1 ] || [ -z "$worker" ]; then
      kill -9 "$campaign" 2> /dev/null || true
      break
    fi
    kill -9 $worker 2> /dev/null || true
  done
  wait "$campaign" 2> /dev/null || true
done
"$screed" campaign run short.ini --out killed --quiet
for one in whole killed; do
  "$screed" campaign merge "$one"
  sha256sum "$one"/runs.csv "$one"/campaign.h5
done
cmp whole/runs.csv killed/runs.csv
cmp whole/campaign.h5 killed/campaign.h5
echo "$runs runs, killed $killed times: the merged files are equal"
