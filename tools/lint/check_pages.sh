#!/bin/bash
# Pages name what there is: a table that people write has a row for each name in the source that it describes, and a
# file that a page names exists. (Keys of experiments and figures of a summary: tests/sitl/program_test.cpp; messages:
# `make telemetry-page`.) Ends with 1 and a line a finding.
set -euo pipefail
status=0
# each_in PAGE BEFORE BEHIND: in the page, each name on standard input stands between the two.
each_in() {
  while read -r name; do
    grep -qE "$2$name$3" "docs/$1" && continue
    echo "docs/$1: $name is missing" >&2
    status=1
  done
}
each_in algorithms.md '^\| `' '` \|' < <(sed -nE 's/^VAL_ [0-9]+ algorithm //p' firmware/protocol/screed.dbc |
  grep -oP '"\K\w+')
each_in boards.md '^\| (`.`, )?`' '([lr]|\.\.\.)?`' < <(grep -oP "(command == |case )'\K\w" hal/avr/console.cpp)
each_in sessions.md '`/?([a-z]+/)?' '\b' < <(
  grep -oP '^inline constexpr char k\w+\[\] = "\K\w+(?=";)' host_sim/run/session/session_layout.h)
# Files, by their path or by its end. Examples that a reader adds are left out, and names in capitals.
files=$(git ls-files)
while IFS=: read -r page file; do
  grep -qE "(^|/)${file//./\\.}$" <<< "$files" && continue
  echo "$page: no file $file" >&2
  status=1
done < <(grep -oHP '`\K[\w./-]+\.(h|cpp|mk|sh|py|awk|S)(?=`)' README.md docs/*.md |
  grep -vE '^docs/(tutorial|extending)|[A-Z]{4}' | sort -u)
exit $status
