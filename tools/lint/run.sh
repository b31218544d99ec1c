#!/bin/bash
# run.sh BUILD SOURCE...: clang-tidy over the sources whose stamp BUILD/<source>.tidy is older than their object, the flags or .clang-tidy.
#
# Sources are looked at in groups (groups.awk says which go together), pasted into one: most of a run is the matching of checks against
# the headers of the libraries, the same for all. What a group brings up is only a hint; each of its sources is then looked at alone,
# and what is said of it there counts.
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
    tests/mcu/*) echo mcu_tests ;;
    *) echo lint ;;
  esac
}

# The sources pasted together; an #include that an earlier one has makes place for an empty line.
paste() {
  awk '/^#include / && ($2 in first) && first[$2] != FILENAME { print ""; next } /^#include / { first[$2] = FILENAME } { print }' "$@"
}

tidy() {  # FILE CLASS
  # shellcheck disable=SC2046  # the flags are words
  clang-tidy --quiet "$1" -- $(cat "$build/$2.flags") 2>&1
}

# A class and its sources. Ends with 1 when one of them is not clean.
look_at() {
  local class=$1 pasted status=0 said
  shift
  if [ $# -gt 1 ]; then
    echo "  TIDY $1 and $(($# - 1)) more"
    pasted=$(mktemp -d "$build/lint.XXXXXX")
    paste "$@" > "$pasted/group.cpp"
    if tidy "$pasted/group.cpp" "$class" > "$pasted/said"; then
      rm -r "$pasted"
      for source in "$@"; do touch "$build/${source%.cpp}.tidy"; done
      return 0
    fi
    [ -n "${LINT_KEEP:-}" ] || rm -r "$pasted"
  fi
  for source in "$@"; do
    echo "  TIDY $source"
    if said=$(tidy "$source" "$class"); then
      mkdir -p "$(dirname "$build/$source")" && touch "$build/${source%.cpp}.tidy"
    else
      status=1
      grep -vE '^[0-9]+ warnings? generated|^Suppressed|^Use -header-filter|^$' <<< "$said"
    fi
  done
  return $status
}

if [ "$1" = --group ]; then
  shift
  look_at "$@"
  exit
fi

for source in "$@"; do
  stamp=$build/${source%.cpp}.tidy
  class=$(flags_of "$source")
  for newer in "$source" "${stamp%.tidy}.o" "$build/$class.flags" .clang-tidy; do
    if [ "$class" = avr ] && [ "$newer" = "${stamp%.tidy}.o" ]; then continue; fi
    [ "$stamp" -nt "$newer" ] && continue
    echo "$class $source ${stamp%.tidy}.d"
    break
  done
done | awk -f $self/groups.awk | xargs -r -d '\n' -n 1 -P "$(nproc)" bash -c "$self/run.sh \"\$0\" --group \$1" "$build"
