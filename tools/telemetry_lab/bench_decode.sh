#!/bin/bash
# bench_decode.sh SCREED TELEMETRY_LAB PROFILE FRAMES: how many frames a second `screed decode` and tshark read of one log. The best of
# three runs of ours, since other programs use the machine too; tshark, which takes long, runs once.
set -euo pipefail
screed=$1 lab=$2 profile=$3 frames=$4

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"$lab" log "$frames" "$folder/radio.log"

now() { echo "${EPOCHREALTIME/./}"; }
# say NAME MICROSECONDS
say() { awk -v name="$1" -v us="$2" -v n="$frames" 'BEGIN { printf "%-24s %8.2f s %12.0f frames/s\n", name, us / 1e6, n / us * 1e6 }'; }
best_of_three() {
  local name=$1 best= begin took
  shift
  for _ in 1 2 3; do
    begin=$(now)
    "$@" > /dev/null 2> "$folder/said"
    took=$(($(now) - begin))
    [ -z "$best" ] || [ "$took" -lt "$best" ] && best=$took
  done
  grep -q " $frames messages of $frames lines" "$folder/said" || { cat "$folder/said" ; exit 1 ; }
  say "$name" "$best"
}
best_of_three "screed decode --csv" "$screed" decode "$folder/radio.log" --csv
best_of_three "screed decode --mcap" "$screed" decode "$folder/radio.log" --mcap

command -v tshark > /dev/null || { echo "tshark is not installed: make deps, or apt install tshark" >&2 ; exit 1 ; }
mkdir -p "$folder/config/profiles"
cp -r "$profile" "$folder/config/profiles/screed"
begin=$(now)
WIRESHARK_CONFIG_DIR=$folder/config tshark -C screed -r "$folder/radio.log" -T fields -e frame.time_epoch -e signal_pdu.attitude.roll \
  -e signal_pdu.attitude.pitch -e signal_pdu.attitude.heading > "$folder/attitude.txt" 2> /dev/null
say "tshark, one message" $(($(now) - begin))
[ "$(wc -l < "$folder/attitude.txt")" -eq "$frames" ]
