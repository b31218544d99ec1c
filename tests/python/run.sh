#!/bin/bash
# Runs every *_test.sh of this folder and ends with "N passed, N failed". A test ends with 0: passed, 77: skipped, after
# one line that says why; anything else: failed, and its output is shown. With CI=true nothing may be skipped: a missing
# package is a failure.
set -uo pipefail
cd "$(dirname "$0")/../.."

log=$(mktemp)
trap 'rm -f "$log"' EXIT
passed=0 failed=0 skipped=0
for test in tests/python/*_test.sh; do
  name=$(basename "$test" _test.sh)
  status=0
  "$test" > "$log" 2>&1 || status=$?
  if [ $status -eq 0 ]; then
    passed=$((passed + 1)); echo "passed: $name: $(tail -n 1 "$log")"
  elif [ $status -eq 77 ] && [ "${CI:-}" != true ]; then
    skipped=$((skipped + 1)); echo "skipped: $name: $(tail -n 1 "$log")"
  else
    failed=$((failed + 1)); cat "$log"; echo "failed: $name, status $status"
  fi
done
[ "$skipped" -gt 0 ] && echo "$skipped skipped"
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
