#!/bin/bash
# run.sh: installs, moves the tree to another folder and runs it from a third. Ends with "N passed, N failed".
#
# The sources are on this machine, too: the moved tree holds an experiment that they do not have, so a program that read theirs would not
# find it.
set -uo pipefail
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT
passed=0
failed=0

check() {  # NAME COMMAND...
  local name=$1
  shift
  if said=$("$@" 2>&1); then
    passed=$((passed + 1))
  else
    failed=$((failed + 1))
    printf '%s: %s\n%s\n' failed "$name" "$said"
  fi
}

make --no-print-directory INSTALLED=yes install PREFIX="$tree/first" > "$tree/log" 2>&1 || { cat "$tree/log"; exit 1; }
mv "$tree/first" "$tree/moved"
data="$tree/moved/share/screed"
mv "$data/experiments/first_drive.ini" "$data/experiments/moved_drive.ini"
screed="$tree/moved/bin/screed"
mkdir "$tree/elsewhere"
cd "$tree/elsewhere" || exit 1

check 'an experiment of its own' "$screed" sim moved_drive --duration 1 --quiet --out native
check 'a model of its own' "$screed" sim soft_bed --hal surrogate --duration 1 --quiet --out surrogate
check 'a robot of its own' "$screed" sim four_wheels --duration 1 --quiet --out wheeled
check 'a session' "$screed" replay native
check 'the flash tool' test -x "$tree/moved/bin/screed_flash"
check 'the docs and the licence' test -s "$tree/moved/share/doc/screed/docs/architecture.md" -a -s "$tree/moved/share/doc/screed/LICENSE"
rm "$data/experiments/moved_drive.ini"
check 'the experiment was that of the tree' bash -c '! "$0" sim moved_drive --duration 1 --out gone' "$screed"

cd "$OLDPWD" || exit 1
make --no-print-directory INSTALLED=yes uninstall PREFIX="$tree/moved" > "$tree/log" 2>&1
check 'uninstall leaves no file' test -z "$(find "$tree/moved" -type f)"

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
