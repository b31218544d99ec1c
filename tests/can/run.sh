#!/bin/bash
# Runs every *_test.sh of this folder and ends with "N passed, N failed". A test ends with 0: passed, 77: skipped, after
# one line that says why; anything else: failed, and its output is shown. With CI=true nothing may be skipped: a missing
# tool is a failure.
set -uo pipefail
cd "$(dirname "$0")/../.."

mkdir -p "$SCREED_CAN_BUILD"
passed=0 failed=0 skipped=0
for test in tests/can/*_test.sh; do
  name=$(basename "$test" _test.sh)
  log=$SCREED_CAN_BUILD/$name.log
  status=0
  "$test" > "$log" 2>&1 || status=$?
  case $status in
    0) passed=$((passed + 1)); echo "passed: $name: $(tail -n 1 "$log")" ;;
    77)
      if [ "${CI:-}" = true ]; then
        failed=$((failed + 1)); echo "failed: $name: skipped, which CI=true does not allow: $(tail -n 1 "$log")"
        continue
      fi
      skipped=$((skipped + 1)); echo "skipped: $name: $(tail -n 1 "$log")"
      ;;
    *) failed=$((failed + 1)); cat "$log"; echo "failed: $name, status $status" ;;
  esac
done
[ "$skipped" -gt 0 ] && echo "$skipped skipped"
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
