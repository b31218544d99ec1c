#!/bin/bash
# check_root.sh [FOLDER]: the project's root holds what is listed here and nothing else, whether committed or not: a
# file that a program leaves behind there is seen before it is committed. What .gitignore names does not count. Ends
# with 1 otherwise.
set -euo pipefail
cd "${1:-.}"

listed='.ci .clang-format .clang-tidy .gitignore CHANGELOG.md LICENSE Makefile README.md'
listed+=' boards docs firmware hal host_sim nn tests tools'
# What is deleted but not yet committed is still in git's list.
found=$(git ls-files --cached --others --exclude-standard | cut -d/ -f1 | LC_ALL=C sort -u | while read -r name; do
  if [ -e "$name" ]; then echo "$name"; fi
done)
strange=$(comm -13 <(tr ' ' '\n' <<< "$listed" | LC_ALL=C sort) <(LC_ALL=C sort <<< "$found"))
[ -z "$strange" ] || {
  echo "the root of the project may not hold: $(echo $strange) (tools/lint/check_root.sh lists what it may)" >&2
  exit 1
}
missing=$(comm -23 <(tr ' ' '\n' <<< "$listed" | LC_ALL=C sort) <(LC_ALL=C sort <<< "$found"))
[ -z "$missing" ] || { echo "tools/lint/check_root.sh lists what is not there: $(echo $missing)" >&2; exit 1; }
