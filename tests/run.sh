#!/bin/bash
# run.sh PROGRAM...: runs the tests of GoogleTest programs, as many at a time as there are processors, and ends with
# "N passed, N failed".
#
# One queue holds the tests of all programs, the longest first: those of half a second and more alone, the others in
# batches of about a second, since a program takes longer to start than most tests to run. How long tests take is known
# from earlier runs of the same programs, if there were any. A program that dies counts as a failed test; its output is
# shown. With CI=true a skipped test counts as failed.
set -uo pipefail

# run_tests PROGRAM NAME:NAME...: prints a line a test to descriptor 3, "passed|failed|skipped MILLISECONDS PROGRAM
# NAME".
run_tests() {
  local program=$1 names=$2 status=0 lines
  "$program" --gtest_brief=1 --gtest_filter="$names" --gtest_output="xml:$mine.xml" > "$mine.log" 2>&1 || status=$?
  if [ -s "$mine.xml" ]; then
    lines=$(awk -v program="$program" '
      function value(attribute) { match($0, " " attribute "=\"[^\"]*\"");
        return substr($0, RSTART + length(attribute) + 3, RLENGTH - length(attribute) - 4) }
      function finish() { if (test != "") print verdict, time, program, test; test = "" }
      /^    <testcase / { finish(); test = value("classname") "." value("name"); time = int(1000 * value("time") + 0.5)
                          verdict = value("result") == "skipped" ? "skipped" : "passed" }
      /^      <failure / { verdict = "failed" }
      END { finish() }' "$mine.xml")
    rm "$mine.xml"
    # Of a sanitizer, say, that looks around at the end.
    if [ $status -ne 0 ] && ! grep -q ^failed <<< "$lines"; then
      lines+=$'\n'"failed 0 $program end_of_the_program"
      echo "$(basename "$program"), $names: ended with status $status" >> "$mine.log"
    fi
    [ $status -ne 0 ] && cat "$mine.log"
    [[ $lines = *skipped* ]] && grep -A1 ': Skipped$' "$mine.log"
    echo "$lines" >&3
  elif [[ $names = *:* ]]; then
    # Which one it died of, and what becomes of the others: each alone.
    echo "$(basename "$program"): ended with status $status before its summary: these tests again, one by one"
    for names in ${names//:/ }; do run_tests "$program" "$names"; done
    grep -q ^failed "$mine.results" || echo "failed 0 $program end_of_the_program" >&3
  else
    cat "$mine.log"
    echo "$(basename "$program"), $names: ended with status $status before its summary"
    echo "failed 0 $program $names" >&3
  fi
}

if [ "$1" = --batch ]; then
  mine=$(mktemp "$2/XXXXXX")
  # shellcheck disable=SC2086  # PROGRAM NAME:NAME...
  said=$(run_tests $3 3> "$mine.results")
  [ -n "$said" ] && echo "$said"
  exit 0
fi

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
times=$(dirname "$1")/times  # of earlier runs: MILLISECONDS PROGRAM NAME
touch "$times"

for program in "$@"; do
  # A parameter's value stands behind the name.
  "$program" --gtest_list_tests |
    awk -v program="$program" '/^[^ ]/ { suite = $1; next } { print program, suite $1; found = 1 }
    END { exit !found }' || echo "$program no_tests_found"
done > "$folder/tests"

# Of a test that has never run: it is quick, unless it lies among the long ones.
awk -v times="$times" '
  function flush() { if (names != "") print sum, program, names; names = ""; sum = 0 }
  FILENAME == times { known[$2 " " $3] = $1; next }
  {
    time = $0 in known ? known[$0] : $1 ~ /long/ ? 10000 : 100
    if (time >= 500) { print time, $0; next }
    if ($1 != program || sum + time > 1000) flush()
    program = $1
    names = names (names == "" ? "" : ":") $2
    sum += time
  }
  END { flush() }' "$times" "$folder/tests" | sort -rn | cut -d' ' -f2- |
  xargs -r -d '\n' -n 1 -P "$(nproc)" "$0" --batch "$folder"

cat "$folder"/*.results 2> /dev/null > "$folder/results"
awk 'FILENAME ~ /results$/ { seen[$3 " " $4] = 1; next } !($0 in seen) { print "failed 0 " $0 }' "$folder/results" \
  "$folder/tests" > "$folder/missing"
[ -s "$folder/missing" ] && cut -d' ' -f3- "$folder/missing" | sed 's/$/: no result/' &&
  cat "$folder/missing" >> "$folder/results"
cut -d' ' -f2- "$folder/results" | cat - "$times" | awk '!seen[$2 " " $3]++' > "$folder/times" &&
  cp "$folder/times" "$times"
echo "The longest:"
sort -k2,2rn "$folder/results" | head -10 | awk '{ printf "%8.1f s  %s\n", $2 / 1000, $4 }'

passed=$(grep -c ^passed "$folder/results")
failed=$(grep -c ^failed "$folder/results")
skipped=$(grep -c ^skipped "$folder/results")
[ "$skipped" -gt 0 ] && echo "$skipped skipped"
if [ "$skipped" -gt 0 ] && [ "${CI:-}" = true ]; then
  echo "with CI=true nothing may be skipped: a missing tool is a failure"
  failed=$((failed + skipped))
fi
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ] && [ "$passed" -gt 0 ]
