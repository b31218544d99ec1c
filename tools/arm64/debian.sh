#!/bin/bash
# What a build for 64-bit Arm takes from Debian beside this system's packages, which stay as they are: apt keeps lists
# and state of its own below FOLDER.
#
# debian.sh sysroot FOLDER LIST...: headers and libraries for arm64 that the lists of packages name, in FOLDER/root, for
# a cross compiler and qemu-user.
# debian.sh ode FOLDER HOST: Debian's source of ODE, compiled by HOST-g++ without fused multiply-add, in FOLDER/lib. On
# arm64 Debian's own
#   library has it, and so gives other bits than on x86-64.
set -euo pipefail
what=$1
mkdir -p "$2"
folder=$(cd "$2" && pwd)
shift 2

# own_apt ARCHITECTURE deb|deb-src: sets apt up. Sources that have nothing for it are no concern of ours.
own_apt() {
  mkdir -p "$folder"/apt/{lists/partial,cache/archives/partial,sources}
  : > "$folder/apt/status"
  local file
  for file in /etc/apt/sources.list /etc/apt/sources.list.d/*; do
    [ -e "$file" ] || continue
    case $file in
      *.list) sed -nE "s/^deb /$2 /p" "$file" > "$folder/apt/sources/$(basename "$file")" ;;
      *.sources) sed -E "s/^Types:.*/Types: $2/" "$file" > "$folder/apt/sources/$(basename "$file")" ;;
    esac
  done
  cat > "$folder/apt/apt.conf" <<END
APT::Architecture "$1";
APT::Architectures { "$1"; };
APT::Sandbox::User "root";
APT::Install-Recommends "false";
Dir::State::status "$folder/apt/status";
Dir::State::lists "$folder/apt/lists";
Dir::Cache "$folder/apt/cache";
Dir::Etc::sourcelist "/dev/null";
Dir::Etc::sourceparts "$folder/apt/sources";
END
  export APT_CONFIG=$folder/apt/apt.conf
  apt-get update -qq 2> "$folder/apt/log" || true
}

case $what in
  sysroot)
    own_apt arm64 deb
    mapfile -t packages < <(sed -e 's/#.*//' "$@" | grep -E '^(lib|zlib|nlohmann|tiny-dnn|python3-numpy)')
    apt-get install -y -qq --download-only libc6-dev libstdc++-12-dev "${packages[@]}" > "$folder/apt/log" 2>&1 ||
      { cat "$folder/apt/log" >&2; exit 1; }
    root=$folder/root.new
    rm -rf "$root" "$folder/root"
    mkdir "$root"
    for package in "$folder"/apt/cache/archives/*.deb; do dpkg-deb -x "$package" "$root"; done
    # Links by name from the root would lead out of here. HDF5's is made only when the package is set up.
    find "$root" -type l -lname '/*' -printf '%p %l\n' | while read -r link to; do
      ln -sfn "$(realpath -m --relative-to="$(dirname "$link")" "$root$to")" "$link"
    done
    ln -s hdf5-serial.pc "$root/usr/lib/aarch64-linux-gnu/pkgconfig/hdf5.pc"
    rm -r "$folder/apt"
    mv "$root" "$folder/root"
    ;;
  ode)
    own_apt "$(dpkg --print-architecture)" deb-src
    mkdir -p "$folder/source"
    (cd "$folder/source" && apt-get source -qq --download-only ode > "$folder/apt/log" 2>&1) ||
      { cat "$folder/apt/log" >&2; exit 1; }
    tar xf "$folder"/source/ode_*.orig.tar.* -C "$folder/source" --strip-components=1
    cd "$folder/source"
    { ./configure --host="$1" --prefix="$folder" --enable-double-precision --disable-shared --disable-demos \
      --with-trimesh=none \
        CFLAGS='-O2 -fPIC -ffp-contract=off' CXXFLAGS='-O2 -fPIC -ffp-contract=off' && make -j"$(nproc)" &&
        make install; } > "$folder/log" 2>&1 ||
      { tail -n 20 "$folder/log" >&2; exit 1; }
    rm -r "$folder/source" "$folder/apt"
    ;;
esac
