#!/bin/bash
# one_class.sh: a class stands in one header. Two of one name in one namespace are one class to the linker, which takes
# the inline functions and destructors of whichever it meets first; no compiler says so when no source includes both.
set -euo pipefail
cd "$(dirname "$0")/../.."

mapfile -t headers < <(find firmware hal host_sim nn tools tests boards -name '*.h' | LC_ALL=C sort)
# clang-format keeps namespaces and what they hold at the left margin.
awk '
  FNR == 1 { space = "" }
  /^namespace [A-Za-z_0-9:]+ \{/ { space = space $2 "::" }
  /^}  \/\/ namespace/ { sub(/[A-Za-z_0-9]+::$/, "", space) }
  /^template</ { next }
  /^(class|struct|union|enum|enum class|enum struct) [^;(]*\{/ {
    name = $0
    sub(/^(enum class|enum struct|class|struct|union|enum) (alignas\([0-9a-zA-Z_]+\) )?/, "", name)
    sub(/[^A-Za-z_0-9<>].*/, "", name)
    if (name == "") next
    ++classes
    key = space name
    if (key in stands && stands[key] != FILENAME) { print FILENAME ": " key " stands in " stands[key] \
      " as well; one of them needs another name"; bad = 1 }
    stands[key] = FILENAME
  }
  END {
    if (classes < 100) { print "tools/lint/one_class.sh: finds " classes + 0 \
      " classes in the headers; have their left margins moved?"; bad = 1 }
    exit bad
  }' "${headers[@]}"
