#!/bin/bash
# commands.sh FILE...: C++ that declares and calls the registration of every subcommand, register_NAME_command() of a
# file *_command.cpp (tools/screed/cli/command.h), by name. GROUP_NAME in the folder of GROUP is a subcommand of
# `screed GROUP`.
set -euo pipefail
export LC_ALL=C

declare -A file_of subcommands
for file in "$@"; do
  names=$(sed -nE 's/^void register_(\w+)_command\(Command&.*/\1/p' "$file")
  [ -n "$names" ] || {
    echo "$file: defines no void register_NAME_command(Command& ..., Program& ...)" >&2
    exit 1
  }
  for name in $names; do
    [ -z "${file_of[$name]:-}" ] || {
      echo "$file: there is a subcommand $name in ${file_of[$name]}" >&2
      exit 1
    }
    file_of[$name]=$file
  done
done

names=$(printf '%s\n' "${!file_of[@]}" | sort)
for name in $names; do
  group=screed
  for prefix in $names; do
    [[ $name == "$prefix"_* && $(dirname "${file_of[$name]}") == $(dirname "${file_of[$prefix]}") ]] && group=$prefix
  done
  subcommands[$group]+="$name "
done

echo '// The subcommands of this build, from the names of their files. Made by tools/build/commands.sh.'
echo '#pragma once'
echo '#include "tools/screed/cli/command.h"'
echo 'namespace screed {'
for name in $names; do
  echo "void register_${name}_command(Command& parent, Program& program);"
done
for group in $(printf '%s\n' "${!subcommands[@]}" | sort); do
  echo "inline void register_${group}_subcommands(Command& parent, Program& program) {"
  for name in ${subcommands[$group]}; do echo "  register_${name}_command(parent, program);"; done
  echo '}'
done
echo '}  // namespace screed'
