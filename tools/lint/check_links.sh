#!/bin/sh
# Every relative link in the Markdown pages leads to a file that exists, and its #anchor to a heading of that page.
# usage: check_links.sh [PAGE...]   (default: all pages that git knows). Ends with 1 and one line per broken link.
set -eu
[ $# -gt 0 ] || set -- $(git ls-files -co --exclude-standard -- '*.md')
exec awk -f "$(dirname "$0")/check_links.awk" "$@"
