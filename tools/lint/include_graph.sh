#!/bin/bash
# include_graph.sh [FOLDER...]: which folder includes which. Ends with 1, and a line a finding, when a file includes
# what its layer may not (layers.txt), or when folders include each other in a cycle. Tests may include everything and
# are left out.
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
  # tsort names the folders of a loop a line each, neighbours beside each other, behind a line that says so. Of each
  # step one include.
  mapfile -t loop < <(sed -e '/input contains a loop/d' -e 's/^tsort: //' "$work/loop" | awk '!seen[$0]++')
  echo "include graph: a cycle of folders: ${loop[*]}"
  for ((i = 0; i < ${#loop[@]}; ++i)); do
    awk -v one="${loop[i]}" -v other="${loop[(i + 1) % ${#loop[@]}]}" '
      function folder(path) { return sub(/\/[^\/]*$/, "", path) ? path : "." }
      { from = folder($1); to = folder($2) }
      ((from == one && to == other) || (from == other && to == one)) &&
        !said[from]++ { print "  " $1 " includes " $2 }' "$work/includes"
  done | sort -u
  status=1
fi
exit $status
