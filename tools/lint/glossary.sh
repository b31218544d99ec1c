#!/bin/bash
# glossary.sh [FILE...]: private words of denied_words.txt in tracked text files (or in those named). Ends with 1 and a
# line a finding.
set -euo pipefail
self=tools/lint
mapfile -t files < <(if [ $# -gt 0 ]; then printf '%s\n' "$@"; else
  git ls-files '*.h' '*.cpp' '*.inc' '*.mk' '*.md' '*.sh' '*.py' '*.awk' '*.ini' '*.dbc' Makefile |
    grep -vE '^(LICENSE|host_sim/data/terrain/|tests/data/)'; fi)
status=0
while IFS=$'\t' read -r pattern use; do
  case $pattern in '#'* | '') continue ;; esac
  first=${pattern:0:1}
  [[ $first == [a-z] ]] && pattern="[${first^}$first]${pattern:1}"
  found=$(grep -nPH -- "(?<![\w-])(?:$pattern)(?![\w-])" "${files[@]}") || [ $? -eq 1 ]
  [ -z "$found" ] && continue
  sed "s|\$|    <- say: $use|" <<< "$found"
  status=1
done < "$self/denied_words.txt"
exit $status
