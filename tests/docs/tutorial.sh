#!/bin/bash
# tutorial.sh PAGE...: runs the blocks ```sh of Markdown pages, from top to bottom, each page in a shell of its own and
# all in one copy of the tree, as a reader would.
# What is built already is copied along, so only what a page changes is compiled. Ends with 1 at the first command
# that fails, with its line in the page.
set -euo pipefail
# A page's make commands are a user's: they stand in no other make.
unset MAKEFLAGS MFLAGS MAKELEVEL MAKEOVERRIDES INSTALLED
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

mkdir "$folder/screed"
git ls-files -z --cached --others --exclude-standard | while IFS= read -rd '' file; do
  if [ -e "$file" ]; then printf '%s\0' "$file"; fi
done | tar -c --null -T - | tar -x -C "$folder/screed"
# Of this commit, though without git: what is built knows it, and is not built anew.
tools/build/version.sh | cut -d' ' -f2,3 > "$folder/screed/tools/build/commit.txt"
# Tests and other kinds of builds are not needed.
for built in build/generated build/schema build/report build/firmware build/release; do
  if [ -d $built ]; then
    tar -c --exclude='build/*/tests' --exclude='build/*/groups/'{UNIT,SITL,MCU,LONG} $built | tar -x -C "$folder/screed"
  fi
done

cd "$folder/screed"
# Debian's programs come first, as on a reader's machine.
export PATH="/usr/bin:$PATH"
for page in "$@"; do
  # Results of the page before are not there.
  rm -rf out
  # Each line of the page becomes a line of the script, so that line numbers are the same.
  awk '/^```/ { in_block = !in_block && $0 == "```sh"; print ""; next } { print in_block ? $0 : "" }' "$page" \
    > "$folder/commands.sh"
  grep -q . "$folder/commands.sh" || { echo "$page has no commands" >&2; exit 1; }
  cat > "$folder/main.sh" <<'END'
set -eE
trap 'status=$?; echo "PAGE:$LINENO: ended with status $status: $BASH_COMMAND" >&2' ERR
END
  sed -i "s|PAGE|$page|" "$folder/main.sh"
  # Sourced, so that LINENO counts the page's lines. No display: windows have no place in it.
  begin=$SECONDS
  if env -u DISPLAY -u WAYLAND_DISPLAY DEPS=no bash -c 'set -m; . "$0"; . "$1"' "$folder/main.sh" \
    "$folder/commands.sh" > "$folder/log" 2>&1 < /dev/null; then
    echo "$page: $(grep -c . "$folder/commands.sh") lines of commands ran in $((SECONDS - begin)) s"
  else
    tail -60 "$folder/log"
    exit 1
  fi
done
