#!/bin/bash
# run.sh BUILD SOURCE...: clang-tidy over the sources whose stamp BUILD/<source>.tidy is older than their object, the flags or .clang-tidy.
#
# Sources are looked at in groups (groups.awk says which go together), pasted into one: most of a run is the matching of checks against
# the headers of the libraries, the same for all. What a group brings up is only a hint: its halves are then looked at, and so on; what is
# said of a source alone counts.
#
# Needs BUILD/firmware.flags, BUILD/lint.flags and BUILD/mcu_tests.flags, and the objects' .d files; of hal/avr BUILD/avr.flags, and no
# objects: those sources are looked at one by one.
set -uo pipefail
build=$1
shift
self=tools/lint

flags_of() {
  case $1 in
    firmware/* | nn/infer/*) echo firmware ;;
    hal/avr/*) echo avr ;;
    tests/mcu/* | tests/long/mcu/*) echo mcu_tests ;;
    tests/*) echo tests ;;
    *) echo lint ;;
  esac
}

# The sources pasted together; an #include that an earlier one has makes place for an empty line.
paste() {
  awk '/^#include / && ($2 in first) && first[$2] != FILENAME { print ""; next } /^#include / { first[$2] = FILENAME } { print }' "$@"
}

# Tests are compiled as the rest, and checked by a list of their own.
flags_file() { [ "$1" = tests ] && echo "$build/lint.flags" || echo "$build/$1.flags"; }

tidy() {  # FILE CLASS
  # shellcheck disable=SC2046  # the flags are words
  clang-tidy --quiet "$1" -- $(cat "$(flags_file "$2")") 2>&1
}

# Whether a class's sources pasted together are clean.
together() {
  local class=$1 pasted status=0
  shift
  pasted=$(mktemp -d "$build/lint.XXXXXX")
  # clang-tidy takes the list of checks from the folder, and those of the folders above.
  case $class in *tests) cp tests/.clang-tidy "$pasted" ;; esac
  paste "$@" > "$pasted/group.cpp"
  tidy "$pasted/group.cpp" "$class" > "$pasted/said" || status=1
  [ $status -ne 0 ] && [ -n "${LINT_KEEP:-}" ] || rm -r "$pasted"
  return $status
}

# A class and its sources. Ends with 1 when one of them is not clean.
look_at() {
  local class=$1 status=0 said half
  shift
  if [ $# -gt 1 ]; then
    echo "  TIDY $1 and $(($# - 1)) more"
    if together "$class" "$@"; then
      for source in "$@"; do touch "$build/${source%.cpp}.tidy"; done
      return 0
    fi
    half=$(($# / 2))
    look_at "$class" "${@:1:half}" || status=1
    look_at "$class" "${@:half+1}" || status=1
    return $status
  fi
  echo "  TIDY $1"
  if said=$(tidy "$1" "$class"); then
    mkdir -p "$(dirname "$build/$1")" && touch "$build/${1%.cpp}.tidy"
    return 0
  fi
  grep -vE '^[0-9]+ warnings? generated|^Suppressed|^Use -header-filter|^$' <<< "$said"
  return 1
}

if [ "$1" = --group ]; then
  shift
  look_at "$@"
  exit
fi

for source in "$@"; do
  stamp=$build/${source%.cpp}.tidy
  class=$(flags_of "$source")
  for newer in "$source" "${stamp%.tidy}.o" "$(flags_file "$class")" .clang-tidy tests/.clang-tidy; do
    if [ "$class" = avr ] && [ "$newer" = "${stamp%.tidy}.o" ]; then continue; fi
    [ "$stamp" -nt "$newer" ] && continue
    echo "$class $source ${stamp%.tidy}.d"
    break
  done
done | awk -f $self/groups.awk | xargs -r -d '\n' -n 1 -P "$(nproc)" bash -c "$self/run.sh \"\$0\" --group \$1" "$build"
