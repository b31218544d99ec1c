#!/bin/bash
# python3-can at the virtual serial port of a simulated robot.
set -euo pipefail
cd "$(dirname "$0")/../.."

# Debian's python, where Debian's packages are.
python=/usr/bin/python3
$python -c 'import can' 2> /dev/null || { echo "python3-can is not installed: apt install python3-can"; exit 77; }

work=$(mktemp -d)
"$SCREED_PROGRAM" sim host_sim/data/experiments/first_drive.ini --pty "$work/radio" --duration 60 --out "$work/run" \
  --quiet > "$work/sim.log" 2>&1 &
sim=$!
trap 'if kill -0 $sim 2> /dev/null; then kill $sim; fi; rm -rf "$work"' EXIT
for _ in $(seq 100); do [ -e "$work/radio" ] && break; sleep 0.1; done
$python tests/can/python_can_test.py "$work/radio"
kill -INT $sim
status=0
wait $sim || status=$?
# 128 + SIGINT: interrupted, and everything up to then is kept.
[ $status -eq 130 ] || { cat "$work/sim.log"; echo "screed sim ended with $status after SIGINT, not with 130"; exit 1; }
# What came from outside is in the recording: it replays to the same bytes.
"$SCREED_PROGRAM" replay "$work/run/session.h5" | grep -q "outputs identical"
$python -c 'import can
print("python-can", can.__version__, "hears the robot at its rates and stops it; the run replays")'
