#!/bin/bash
# run.sh FOLDER: the Debian packages in FOLDER, by lintian, and in a fresh Debian of their own: installed, run from
# another folder by their autopkgtests, purged. SCREED_PROGRAM is the program of the same sources. Ends with "N passed,
# N failed". Needs root, for the chroot.
set -uo pipefail
packages=$(cd "$1" && pwd)
. tests/check.sh
fresh=$(mktemp -d)
here=$(mktemp -d)
trap 'umount "$fresh/proc" 2> /dev/null; rm -rf --one-file-system "$fresh" "$here"' EXIT
inside() { chroot "$fresh" env DEBIAN_FRONTEND=noninteractive LC_ALL=C.UTF-8 "$@"; }
files() {
  (cd "$fresh" && find . -xdev -not -path './proc/*' -not -path './var/*' -not -path './tmp/*' | LC_ALL=C sort)
}
# The hash that the program COMMAND... prints of a run.
hash_of() {  # FOLDER COMMAND...
  local folder=$1
  shift
  "$@" sim level_bed --hal surrogate --duration 20 --no-pictures --quiet --out "$folder/same" | cut -d' ' -f2
}

check 'lintian finds neither errors nor warnings' lintian --allow-root --fail-on error,warning "$packages"/*.changes

# From where this machine's apt takes its packages.
mmdebstrap --quiet --variant=apt bookworm "$fresh" $(ls /etc/apt/sources.list /etc/apt/sources.list.d/* 2> /dev/null) \
  > "$packages/chroot.log" 2>&1 || { tail "$packages/chroot.log"; exit 1; }
mkdir "$fresh/packages"
cp "$packages"/*.deb "$fresh/packages"
cp -r tools/package/debian/tests "$fresh/tests"
mount -t proc proc "$fresh/proc"
# What the tests and the packages need comes first: what is there before the packages is there after them.
wanted=$({ sed -n 's/^Depends: //p' tools/package/debian/tests/control
  for package in "$packages"/*.deb; do dpkg-deb -f "$package" Depends; echo; done; } |
  tr ',|' '\n\n' | sed 's/(.*//; s/ //g' | grep -v -e screed -e '^$' | sort -u)
check 'what they depend on is in Debian' \
  inside sh -c "apt-get update -qq && apt-get install -qq -y --no-install-recommends $(echo $wanted)"
files > "$here/before"
installed_and_tried() {  # TEST PACKAGE...
  local test=$1
  shift
  check "apt installs $*" \
    inside sh -c "apt-get install -qq -y --no-install-recommends $(printf '/packages/%s_*.deb ' "$@")"
  check "autopkgtest $test" inside sh -c "mkdir -p /tmp/$test && cd / && AUTOPKGTEST_TMP=/tmp/$test /tests/$test"
}
installed_and_tried python python3-screed libscreed0 screed-data
installed_and_tried library libscreed-dev libscreed-soil0
installed_and_tried run screed screed-firmware
mine=$(hash_of "$here" "$SCREED_PROGRAM")
check 'the bits of the tree' test -n "$mine" -a "$(hash_of /tmp inside screed)" = "$mine"
check 'purging works' inside sh -c 'apt-get purge --auto-remove -qq -y "screed*" "libscreed*" python3-screed'
files > "$here/after"
check 'and leaves no file outside of /var and /tmp' diff "$here/before" "$here/after"

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
