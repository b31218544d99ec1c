#!/bin/bash
# install-deps.sh yes|no LIST...: installs the Debian packages of the lists that are missing.
set -euo pipefail

wanted=$1
shift
[ "$wanted" = no ] && exit 0

mapfile -t packages < <(sed -e 's/#.*//' -e '/^[[:space:]]*$/d' "$@")
command -v dpkg-query > /dev/null \
  || { echo "make deps: no dpkg-query; install these by other means, then use DEPS=no: ${packages[*]}" >&2; exit 1; }
# dpkg-query ends with 1 when it does not know one of them.
installed=$({ dpkg-query -W -f '${Package} ${db:Status-Abbrev}\n' "${packages[@]}" 2> /dev/null ||
  [ $? -eq 1 ] || { echo "make deps: dpkg-query failed" >&2; false; }; } | awk '$2 == "ii" {print $1}')
missing=$(comm -23 <(printf '%s\n' "${packages[@]}" | sort) <(printf '%s\n' $installed | sort))
[ -z "$missing" ] && exit 0

echo "installing:" $missing
root=()
if [ "$(id -u)" -ne 0 ]; then
  command -v sudo > /dev/null \
    || { echo "make deps: not root and no sudo; install these packages: $(echo $missing)" >&2; exit 1; }
  root=(sudo)
fi
"${root[@]}" apt-get update -qq
"${root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $missing > /dev/null
