#!/bin/bash
# tidy.sh STAMP FLAGS CHECKS SOURCE...: clang-tidy over sources pasted into one (paste.awk), with the flags of a file
# and CHECKS behind those of .clang-tidy. Of sources that do not compile together, each half is looked at. Makes STAMP
# when all are clean.
set -uo pipefail
stamp=$1 flags=$2 checks=$3
shift 3

# The analyser gives up a function after so many steps: most of its time would go into what lies beyond, long functions
# of many branches.
# Firmware is looked at to the end.
steps=4000
case $flags in */firmware.flags | */avr.flags) steps=225000 ;; esac
deep=()
for word in -Xclang -analyzer-config -Xclang "max-nodes=$steps"; do deep+=("--extra-arg=$word"); done

tidy() {
  # shellcheck disable=SC2046  # the flags are words
  clang-tidy --quiet "${deep[@]}" --checks="$checks" "$1" -- $(cat "$flags") > "$stamp.log" 2>&1
}
# Findings, with the places in the pasted text (if there is one) as places in the sources.
show() {
  touch "$stamp.cpp"
  awk -v pasted="$(basename "$stamp.cpp")" '
    NR == FNR { if (/^#line /) { at[++count] = FNR; first[count] = $2; file[count] = substr($3, 2, length($3) - 2) } \
      next }
    /^[0-9]+ warnings? generated|^Suppressed|^Use -header-filter|^$/ { next }
    match($0, /^[^ :]*:[0-9]+:/) && index($0, pasted ":") {
      split(substr($0, 1, RLENGTH), part, ":")
      for (i = count; i > 1 && at[i] > part[2]; --i) continue
      $0 = file[i] ":" (first[i] + part[2] - at[i] - 1) substr($0, RLENGTH)
    }
    { print }' "$stamp.cpp" "$stamp.log"
}

# Sources together; where they do not compile so, each half of them. Ends with 1 when one is not clean.
look_at() {
  local status=0
  if [ $# -eq 1 ]; then
    echo "  TIDY $1"
    rm -f "$stamp.cpp"
    tidy "$1" || { show; return 1; }
    return 0
  fi
  awk -f tools/lint/paste.awk "$@" "$@" > "$stamp.cpp"
  if tidy "$stamp.cpp"; then
    echo "  TIDY $1 and $(($# - 1)) more"
    return 0
  fi
  grep -q 'clang-diagnostic-error' "$stamp.log" || { show; return 1; }
  look_at "${@:1:$# / 2}" || status=1
  look_at "${@:$# / 2 + 1}" || status=1
  return $status
}

mkdir -p "$(dirname "$stamp")"
look_at "$@" && touch "$stamp"
