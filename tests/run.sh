#!/bin/bash
# run.sh PROGRAM...: runs GoogleTest programs, two shards each in parallel, and ends with "N passed, N failed".
# A program that dies counts as a failed test; its output is shown. With CI=true a skipped test counts as failed.
set -uo pipefail

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
shards=$(nproc)

jobs_begun=()
for program in "$@"; do
  name=$(basename "$program")
  for ((shard = 0; shard < shards; ++shard)); do
    (
      status=0
      GTEST_TOTAL_SHARDS=$shards GTEST_SHARD_INDEX=$shard "$program" --gtest_brief=1 --gtest_output="json:$folder/$name.$shard.json" \
        > "$folder/$name.$shard.log" 2>&1 || status=$?
      echo "$status" > "$folder/$name.$shard.status"
    ) &
  done
  wait
  jobs_begun+=("$name")
done

passed=0
failed=0
skipped=0
for name in "${jobs_begun[@]}"; do
  for ((shard = 0; shard < shards; ++shard)); do
    base=$folder/$name.$shard
    status=$(cat "$base.status")
    # Of the program's own summary; absent when it ended on the way, with whatever status.
    tests=0
    failures=0
    skips=0
    if [ -s "$base.json" ]; then
      tests=$(grep -m1 -oE '"tests": [0-9]+' "$base.json" | grep -oE '[0-9]+')
      failures=$(grep -m1 -oE '"failures": [0-9]+' "$base.json" | grep -oE '[0-9]+')
      # A skipped test has not passed: it is said, and not counted.
      skips=$(grep -c '"result": "SKIPPED"' "$base.json")
    fi
    if [ "$status" -ne 0 ] || [ ! -s "$base.json" ]; then
      cat "$base.log"
      [ "$failures" -eq 0 ] && failures=1 && echo "$name, shard $shard: ended with status $status$([ -s "$base.json" ] || echo ' before its summary')"
      [ "$tests" -lt "$failures" ] && tests=$failures
    fi
    [ "$skips" -gt 0 ] && grep -A1 ': Skipped$' "$base.log"
    skipped=$((skipped + skips))
    passed=$((passed + tests - failures - skips))
    failed=$((failed + failures))
  done
done

[ "$skipped" -gt 0 ] && echo "$skipped skipped"
if [ "$skipped" -gt 0 ] && [ "${CI:-}" = true ]; then
  echo "with CI=true nothing may be skipped: a missing tool is a failure"
  failed=$((failed + skipped))
fi
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ] && [ "$passed" -gt 0 ]
