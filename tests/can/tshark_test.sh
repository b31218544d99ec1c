#!/bin/bash
# tshark, with the tables that the schema compiler makes for it, reads every signal of a log as `screed decode` does:
# random messages of three robots and of the ground, edges among them.
set -euo pipefail

cd "$(dirname "$0")/../.."

command -v tshark > /dev/null || { echo "tshark is not installed: apt install tshark" ; exit 77 ; }
frames=20000
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"$TELEMETRY_LAB_PROGRAM" log $frames "$folder/radio.log"
"$SCREED_PROGRAM" decode "$folder/radio.log" --csv --numbers --out "$folder/ours" > /dev/null 2> "$folder/account"
grep -q " $frames messages of $frames lines" "$folder/account" || { cat "$folder/account" ; exit 1 ; }

mkdir -p "$folder/config/profiles"
cp -r "$SCREED_WIRESHARK_PROFILE" "$folder/config/profiles/screed"
export WIRESHARK_CONFIG_DIR=$folder/config

# Our header without units names the fields: time, robot, signals.
compared=0
rows=0
for table in "$folder"/ours/*.csv; do
  message=$(basename "$table" .csv)
  [ "$message" != track_slip ] || continue  # what the ground derives of several messages: none that travels
  fields=(-e frame.time_epoch -e can.id)
  IFS=, read -ra columns <<< "$(head -n 1 "$table" | sed 's/ \[[^]]*\]//g')"
  for signal in "${columns[@]:2}"; do fields+=(-e "signal_pdu.$message.$signal"); done
  # A broken table of the profile would be said on standard error, an unknown field as well.
  tshark -C screed -r "$folder/radio.log" -Y "signal_pdu.name == \"${message^^}\"" -T fields -E separator=, \
    "${fields[@]}" \
    > "$folder/theirs.csv" 2> "$folder/said" || { echo "tshark ended with $?:" ; cat "$folder/said" ; exit 1 ; }
  if grep -vi 'running as user "root"' "$folder/said" | grep -q .; then cat "$folder/said" ; exit 1 ; fi
  awk -F, -v message="$message" -v names="$(head -n 1 "$table")" '
    function differs(a, b) { return a == "" || b == "" || (a - b)^2 > 1e-18 * (1 + a^2) }
    BEGIN { split(names, name, ",") }
    NR == FNR { if (FNR > 1) ours[FNR - 1] = $0; most = FNR - 1; next }
    {
      split(ours[FNR], our, ",")
      node = int($2 / 16) % 16
      if (differs(our[1], $1) || our[2] != node) { print message ", row " FNR ": other frames: " ours[FNR] " / " $0;
        exit failed = 1 }
      for (i = 3; i <= NF; ++i) if (differs(our[i], $i)) {
        print message "." name[i] ", row " FNR ": " our[i] " of ours, " $i " of tshark"; exit failed = 1
      }
    }
    END { if (!failed && FNR != most) { print message ": " most " rows of ours, " FNR " of tshark"; exit 1 } }
  ' "$table" "$folder/theirs.csv"
  compared=$((compared + ${#columns[@]} - 2))
  rows=$((rows + $(wc -l < "$table") - 1))
done
[ "$rows" -eq $frames ]
echo "$compared signals of $rows frames are the same in $(tshark --version 2> /dev/null | head -n 1 | cut -d' ' -f1-3)"
