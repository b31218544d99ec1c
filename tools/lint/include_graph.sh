#!/bin/bash
# include_graph.sh [FOLDER...]: which folder includes which. Ends with 1, and a line a finding, when a file includes what its layer
# may not (layers.txt), or when folders include each other in a cycle. Tests may include everything and are left out.
set -euo pipefail
self=tools/lint
folders=("${@:-firmware hal host_sim nn tools boards}")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# "FILE INCLUDED" of every include between quotes.
# shellcheck disable=SC2068  # folders are words
find ${folders[@]} \( -name '*.h' -o -name '*.cpp' -o -name '*.inc' -o -name '*.ino' \) -print0 | LC_ALL=C sort -z \
  | xargs -0 awk '/^#include "/ { split($0, part, "\""); print FILENAME, part[2] }' > "$work/includes"
[ -s "$work/includes" ] || { echo "include graph: no includes found below ${folders[*]}" >&2 ; exit 1 ; }

status=0
awk -v edges="$work/edges" -f "$self/include_graph.awk" "$self/layers.txt" "$work/includes" || status=1
if ! tsort "$work/edges" > /dev/null 2> "$work/loop"; then
  # tsort names the members of a loop a line each, behind a line that says so.
  sed -e '/input contains a loop/d' -e 's/^tsort: //' "$work/loop" | awk '!seen[$0]++' | paste -sd ' ' \
    | sed 's/^/include graph: a cycle of folders: /'
  while read -r from to; do
    if grep -qx "tsort: $from" "$work/loop" && grep -qx "tsort: $to" "$work/loop"; then
      awk -v from="$from" -v to="$to" '
        function folder(path) { return sub(/\/[^\/]*$/, "", path) ? path : "." }
        folder($1) == from && folder($2) == to { print "  " $1 " includes " $2 }' "$work/includes"
    fi
  done < "$work/edges"
  status=1
fi
exit $status
