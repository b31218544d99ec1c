#!/bin/bash
# bench_decode.sh SCREED TELEMETRY_LAB PROFILE FRAMES: how many frames a second `screed decode` and tshark read of one
# log. Wall clock, the best of three runs of ours (tshark, which takes long, runs once), and the processor's time, which
# other programs disturb less.
set -euo pipefail
screed=$1 lab=$2 profile=$3 frames=$4

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"$lab" log "$frames" "$folder/radio.log"
TIMEFORMAT='%R %U %S'

# measure NAME RUNS COMMAND...: runs it, its output to $folder/out, and prints a line of the table.
measure() {
  local name=$1 runs=$2 run
  shift 2
  : > "$folder/times"
  for ((run = 0; run < runs; ++run)); do
    { time "$@" > "$folder/out" 2> "$folder/said" ; } 2>> "$folder/times"
  done
  sort -n "$folder/times" | head -n 1 | awk -v name="$name" -v n="$frames" '{
    cpu = $2 + $3
    printf "%-22s %7.2f s %11.0f frames/s     processor %7.2f s %11.0f frames/s\n", name, $1, n / $1, cpu, n / cpu }'
}
all_read() {
  grep -q " $frames messages of $frames lines" "$folder/said" || { cat "$folder/said" ; exit 1 ; }
}

measure "screed decode --csv" 3 "$screed" decode "$folder/radio.log" --csv
all_read
measure "screed decode --mcap" 3 "$screed" decode "$folder/radio.log" --mcap
all_read
command -v tshark > /dev/null || { echo "tshark is not installed: apt install tshark" >&2 ; exit 1 ; }
mkdir -p "$folder/config/profiles"
cp -r "$profile" "$folder/config/profiles/screed"
export WIRESHARK_CONFIG_DIR=$folder/config
measure "tshark, 3 signals" 1 tshark -C screed -r "$folder/radio.log" -T fields -e frame.time_epoch \
  -e signal_pdu.attitude.roll \
  -e signal_pdu.attitude.pitch -e signal_pdu.attitude.heading
[ "$(wc -l < "$folder/out")" -eq "$frames" ]
