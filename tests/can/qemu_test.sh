#!/bin/bash
# Real SocketCAN: Debian's kernel under QEMU, since the build machine's kernel need not have CAN. tests/can/guest.sh
# runs inside as the first process. The guest's verdict is QEMU's exit code: only a pass writes the pass value to the
# debug exit port (a kernel that panics makes QEMU end with 0).
set -euo pipefail
cd "$(dirname "$0")/../.."

skip() { echo "$*"; exit 77; }
work=$SCREED_CAN_BUILD/guest
mkdir -p "$work"

command -v qemu-system-x86_64 > /dev/null || skip "QEMU is not installed: apt install qemu-system-x86"
for program in candump cansend slcand canplayer busybox cpio; do
  command -v $program > /dev/null || skip "$program is not installed: see tests/can/debian-packages.txt"
done

# The kernel's package is taken apart, not installed. The cloud kernel has no CAN: linux-image-amd64 is the plain one.
kernel=$work/kernel
if [ ! -e "$kernel/done" ]; then
  rm -rf "$kernel" && mkdir -p "$kernel"
  package=$(apt-cache depends linux-image-amd64 | sed -n 's/^ *Depends: *\(linux-image-[0-9].*\)/\1/p')
  (cd "$kernel" && apt-get download -qq "$package") || skip "Debian's kernel package cannot be downloaded"
  dpkg-deb -x "$kernel"/linux-image-*.deb "$kernel"
  touch "$kernel/done"
fi

# The guest's whole file system: busybox, the modules, the programs under test and their libraries.
root=$work/root
rm -rf "$root" && mkdir -p "$root"/{bin,dev,proc,sys,tmp,etc,modules}
cp "$(command -v busybox)" "$root/bin/"
programs=("$SCREED_PROGRAM" "$(command -v candump)" "$(command -v cansend)" "$(command -v slcand)" \
  "$(command -v canplayer)")
cp "${programs[@]}" "$root/bin/"
ldd "${programs[@]}" | grep -oE '/[^ :]+\.so[^ :]*' | sort -u | while read -r library; do
  mkdir -p "$root$(dirname "$library")" && cp -L "$library" "$root$library"
done
for module in can can-raw can-dev vcan slcan; do
  find "$kernel/lib/modules" -name "$module.ko" -exec cp {} "$root/modules/" \;
done
# The data as an installed program finds it: ../share/screed beside its folder.
data=$root/share/screed
mkdir -p "$data"
cp -r host_sim/data/experiments host_sim/data/terrain boards "$data/"
install -m 755 tests/can/guest.sh "$root/init"
(cd "$root" && find . | LC_ALL=C sort | cpio --quiet -o -H newc) > "$work/initramfs"

status=0
timeout 600 qemu-system-x86_64 -M pc -accel tcg -m 1024 -smp 2 -nodefaults -no-reboot -display none -serial stdio \
  -device isa-debug-exit,iobase=0xf4,iosize=0x04 -kernel "$kernel"/boot/vmlinuz-* -initrd "$work/initramfs" \
  -append "console=ttyS0 quiet panic=-1 rdinit=/init" < /dev/null | tee "$work/console.log" || status=${PIPESTATUS[0]}
# isa-debug-exit makes value * 2 + 1 of what guest.sh writes: 42 for a pass.
[ "$status" -eq 85 ] || { echo "the guest did not pass (QEMU ended with $status)"; exit 1; }
grep -a '^guest: ' "$work/console.log" | tail -n 1 | tr -d '\r'
