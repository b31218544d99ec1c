#!/bin/bash
# version.sh [FOLDER]: NUMBER COMMIT DATE of the sources in FOLDER (default: those that this script belongs to), for the
# build.
#
# The number is that of the newest release in CHANGELOG.md. Commit and date come from git, in an archive that `git
# archive` made from commit.txt; elsewhere the commit is `unknown` and the date that of the release. A commit with
# changes beside it ends in -dirty.
set -euo pipefail
folder=$(cd "${1:-$(dirname "$0")/../..}" && pwd -P)
cd "$folder"

read -r number released < <(sed -nE 's/^## \[([0-9]+\.[0-9]+\.[0-9]+)\] - ([0-9-]+)$/\1 \2/p' CHANGELOG.md) || true
[ -n "${released:-}" ] || { echo "CHANGELOG.md: no release: expected a line '## [1.2.3] - 2026-01-31'" >&2; exit 1; }

# `make install` as another user than the owner of the sources must not change the version, and so build anew.
git=(git -c safe.directory="$folder")
commit=unknown
date=$released
# An archive that was unpacked inside another repository is not of that repository.
if [ "$("${git[@]}" rev-parse --show-toplevel 2> /dev/null)" = "$folder" ] &&
  git_date=$("${git[@]}" log -1 --format=%cs 2> /dev/null); then
  commit=$("${git[@]}" describe --always --dirty --exclude='*')
  date=$git_date
elif read -r archived archived_date < tools/build/commit.txt && [[ $archived != *Format* ]]; then
  commit=$archived
  date=$archived_date
fi
echo "$number $commit $date"
