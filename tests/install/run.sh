#!/bin/bash
# run.sh: installs, moves the tree to another folder and runs it from a third. Ends with "N passed, N failed".
#
# The sources are on this machine, too: the moved tree holds an experiment that they do not have, so a program that read
# theirs would not find it.
set -uo pipefail
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT
. tests/check.sh

make --no-print-directory INSTALLED=yes install PREFIX="$tree/first" > "$tree/log" 2>&1 || { cat "$tree/log"; exit 1; }
check 'installing builds nothing' bash -c '! grep -E "^ +(CXX|LINK|AVR) " "$0"' "$tree/log"
# As root in the tree of a user: git does not trust that tree, and the version must be the same all the same.
GIT_TEST_ASSUME_DIFFERENT_OWNER=1 make --no-print-directory INSTALLED=yes install PREFIX="$tree/other" \
  > "$tree/log" 2>&1
check 'nor does installing as another user' bash -c '! grep -E "^ +(CXX|LINK|AVR) " "$0"' "$tree/log"
mv "$tree/first" "$tree/moved"
data="$tree/moved/share/screed"
mv "$data/experiments/first_drive.ini" "$data/experiments/moved_drive.ini"
screed="$tree/moved/bin/screed"
mkdir "$tree/elsewhere"
cd "$tree/elsewhere" || exit 1

check 'an experiment of its own' "$screed" sim moved_drive --duration 1 --quiet --out native
check 'a model of its own' "$screed" sim soft_bed --hal surrogate --model "$data/models/v2_products.json" --duration 1 \
  --quiet --out surrogate
check 'a robot of its own' "$screed" sim four_wheels --duration 1 --quiet --out wheeled
check 'a session' "$screed" replay native
check 'a page of it' "$screed" report native
check 'the flash tool' "$tree/moved/bin/screed_flash" fuses --mcu atmega32u4
check 'the udev rule' test -s "$tree/moved/lib/udev/rules.d/60-screed.rules"
check 'completion for bash' bash -n "$tree/moved/share/bash-completion/completions/screed"
check 'completion for zsh and fish' test -s "$tree/moved/share/zsh/site-functions/_screed" \
  -a -s "$tree/moved/share/fish/vendor_completions.d/screed.fish"
check 'a man page of the program' man -M "$tree/moved/share/man" -w screed
check 'a man page of each subcommand' bash \
  -c '[ "$(ls "$0"/screed-*.1 | wc -l)" -eq "$("$1" --help | sed -n "/^Subcommands:/,/^$/p" | grep -cE "^  [a-z]")" ]' \
  "$tree/moved/share/man/man1" "$screed"
check 'the version' bash -c '[[ "$("$0" --version | head -n 1)" =~ ^screed\ [0-9.]+.*\ \([0-9-]+\)$ ]]' "$screed"
check 'what is built in' bash -c '"$0" --version | grep -E "^built in: ODE $1, HDF5 [0-9.]+, (no )?simavr"' \
  "$screed" "$(pkg-config --modversion ode)"
check 'the licences of the terrains' test -n "$(find "$data/terrain" -iname '*README*' -o -iname '*LICEN*')"
check 'the docs and the licence' test -s "$tree/moved/share/doc/screed/docs/architecture.md" \
  -a -s "$tree/moved/share/doc/screed/CHANGELOG.md" -a -s "$tree/moved/share/doc/screed/LICENSE"
rm "$data/experiments/moved_drive.ini"
check 'the experiment was that of the tree' bash -c '! "$0" sim moved_drive --duration 1 --out gone' "$screed"

cd "$OLDPWD" || exit 1
make --no-print-directory INSTALLED=yes uninstall PREFIX="$tree/moved" > "$tree/log" 2>&1
check 'uninstall leaves no file' test -z "$(find "$tree/moved" -type f)"

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
