#!/bin/bash
# run.sh FOLDER: the Debian packages in FOLDER, by lintian, and in a fresh Debian of their own: installed, run from
# another folder by their autopkgtests, purged. Ends with "N passed, N failed". Needs root, for the chroot.
set -uo pipefail
packages=$(cd "$1" && pwd)
here=$PWD
. tests/check.sh
fresh=$(mktemp -d)
trap 'umount -R "$fresh/proc" 2> /dev/null; rm -rf "$fresh" /tmp/same' EXIT

lintian --fail-on error,warning --tag-display-limit 0 "$packages"/*.changes > "$packages/lintian.log" 2>&1
status=$?
cat "$packages/lintian.log"
check 'lintian finds neither errors nor warnings' test $status -eq 0

# The sources of this machine's apt, whatever mirror they name.
mmdebstrap --quiet --variant=apt bookworm "$fresh" $(ls /etc/apt/sources.list /etc/apt/sources.list.d/* 2> /dev/null) \
  > "$packages/chroot.log" 2>&1 || { tail "$packages/chroot.log"; exit 1; }
mkdir "$fresh/packages"
cp "$packages"/*.deb "$fresh/packages"
rm -f "$fresh"/packages/*dbgsym*
cp -r "$here/tools/package/debian/tests" "$fresh/tests"
mount -t proc proc "$fresh/proc"
inside() { chroot "$fresh" env DEBIAN_FRONTEND=noninteractive LC_ALL=C.UTF-8 "$@"; }
files() {
  (cd "$fresh" && find . -xdev -not -path './proc/*' -not -path './var/*' -not -path './tmp/*' | LC_ALL=C sort)
}

inside apt-get update -qq > /dev/null 2>&1
# What they depend on first: what is there before the packages is there after them.
inside apt-get install -qq -y --no-install-recommends ca-certificates man-db g++ pkg-config \
  $(for package in "$packages"/*.deb; do dpkg-deb -f "$package" Depends; done | tr ',|' '\n\n' | sed 's/(.*//; s/ //g' |
    grep -v -e screed -e '^$' | sort -u) > "$packages/apt.log" 2>&1
files > "$fresh/var/before"
check 'apt installs them' inside sh -c 'apt-get install -qq -y /packages/*.deb' 
for test in run library python; do
  check "autopkgtest $test" inside sh -c "mkdir -p /tmp/$test && cd / && AUTOPKGTEST_TMP=/tmp/$test /tests/$test"
done
hash_of() { "$@" sim level_bed --hal surrogate --duration 20 --no-pictures --quiet --out /tmp/same | cut -d' ' -f2; }
check 'the bits of the tree' test "$(hash_of inside screed)" = "$(hash_of "$here/build/release/screed")"
check 'the version' bash -c '[[ "$(chroot "$0" screed --version)" == "screed $1"* ]]' "$fresh" \
  "$(sed -nE 's/^## \[([0-9.]+)\] - .*/\1/p' CHANGELOG.md | head -1)"
check 'purging works' inside sh -c 'apt-get purge --auto-remove -qq -y "screed*" "libscreed*" python3-screed'
files > "$fresh/var/after"
check 'and leaves no trace' diff "$fresh/var/before" "$fresh/var/after"

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
