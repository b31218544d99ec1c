#!/bin/bash
# The leveling metrics of runs on every kind of loose terrain, against SciPy.
set -euo pipefail
cd "$(dirname "$0")/../.."

# Debian's python, where Debian's packages are.
python=/usr/bin/python3
$python -c 'import h5py, scipy' 2> /dev/null \
  || { echo "python3-h5py or python3-scipy is not installed: apt install python3-h5py python3-scipy"; exit 77; }

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
sim() {
  "$SCREED_PROGRAM" sim "$@" --quiet > "$work/log" 2>&1 || { cat "$work/log"; exit 1; }
}
# Walls and two sides of different length; terrain that repeats; stones.
sim soft_bed --no-pictures --duration 20 --set map.size=1.5 --set soil.cell=0.01 --out "$work/walled"
sim soft_bed --no-pictures --duration 20 --set map.size=1.0 --set soil.cell=0.01 --set map.edges=wrap \
  --set soil.preset=gravel --out "$work/wrapped"
sim gravel_bed --no-pictures --duration 5 --set map.size=0.8 --out "$work/stones"
$python tests/python/leveling_metrics_test.py "$work"/{walled,wrapped,stones}/session.h5
