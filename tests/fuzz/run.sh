#!/bin/bash
# run.sh BUILD EXECUTIONS TARGET...: fuzzes each target for so many executions, all at the same time, and says in a line
# what came of it.
# A target that ends well after fewer executions than that has failed too, and so has a call without a target.
set -uo pipefail
build=$1 executions=$2
shift 2
[[ $executions =~ ^[1-9][0-9]*$ ]] || { echo "fuzz: EXECUTIONS=$executions: a whole number, 1 or more" >&2; exit 2; }
[ $# -gt 0 ] || { echo "fuzz: no targets" >&2; exit 2; }

fuzz() {
  local target=$1 log=$build/$1.log status=0 done
  mkdir -p "$build/corpus/$target"
  # A hang never ends; the clock is that of the wall, and other programs use the machine too.
  "$build/$target" -runs="$executions" -max_len=512 -timeout=60 -rss_limit_mb=1024 -print_final_stats=1 -seed=1 \
    -artifact_prefix="$build/$target-" "$build/corpus/$target" "tests/fuzz/corpus/$target" > "$log" 2>&1 || status=$?
  done=$(sed -n 's/^stat::number_of_executed_units: *//p' "$log")
  if [ "$status" -eq 0 ] && [ "${done:-0}" -ge "$executions" ]; then
    echo "$target: $done executions, nothing found"
  elif [ "$status" -eq 0 ]; then
    tail -n 40 "$log"
    echo "$target: only ${done:-no} executions of $executions"
    status=1
  else
    tail -n 40 "$log"
    echo "$target: broken after ${done:-?} executions"
  fi
  return "$status"
}

running=()
for target in "$@"; do
  fuzz "$target" &
  running+=($!)
done
failed=0
for pid in "${running[@]}"; do wait "$pid" || failed=1; done
exit "$failed"
