#!/bin/bash
# run.sh PROGRAM...: runs GoogleTest programs, two shards each in parallel, and ends with "N passed, N failed".
# A program that dies counts as a failed test; its output is shown.
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
    # Of the program's own summary; absent when it died on the way.
    tests=$(grep -m1 -oE '"tests": [0-9]+' "$base.json" 2> /dev/null | grep -oE '[0-9]+' || echo 0)
    failures=$(grep -m1 -oE '"failures": [0-9]+' "$base.json" 2> /dev/null | grep -oE '[0-9]+' || echo 0)
    if [ "$status" -ne 0 ]; then
      cat "$base.log"
      [ "$failures" -eq 0 ] && failures=1 && echo "$name, shard $shard: ended with status $status"
      [ "$tests" -lt "$failures" ] && tests=$failures
    fi
    # A skipped test has not passed: it is said, and not counted.
    skips=$(grep -c '"result": "SKIPPED"' "$base.json" 2> /dev/null || true)
    skips=${skips:-0}
    [ "$skips" -gt 0 ] && grep -A1 ': Skipped$' "$base.log"
    skipped=$((skipped + skips))
    passed=$((passed + tests - failures - skips))
    failed=$((failed + failures))
  done
done

[ "$skipped" -gt 0 ] && echo "$skipped skipped"
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ] && [ "$passed" -gt 0 ]
