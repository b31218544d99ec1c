#!/bin/busybox sh
# The first process of the guest of qemu_test.sh: our program and can-utils on vcan and slcan.
/bin/busybox --install -s /bin
export PATH=/bin
mount -t proc proc /proc
mount -t sysfs sys /sys
mount -t devtmpfs dev /dev
mkdir -p /dev/pts
mount -t devpts devpts /dev/pts

end() { # value for the debug exit port
  sync
  printf "\\x$(printf %x "$1")" | dd of=/dev/port bs=1 seek=244 2> /dev/null
  sleep 5
}
checks=0
fail() { echo "guest: FAILED: $*"; end 1; }
pass() { checks=$((checks + 1)); echo "guest: ok: $*"; }

for module in can can-raw can-dev vcan slcan; do
  insmod /modules/$module.ko || fail "insmod $module"
done
ip link add dev vcan0 type vcan && ip link set vcan0 up || fail "no vcan0"
cd /tmp

# Lines of a candump log without time and interface.
frames() { sed -n 's/^([0-9.]*) [^ ]* //p' "$1"; }

# --- the simulator's frames on vcan, as candump sees them -----------------------------------------------------------------------
candump -r 4194304 -d -L vcan0 > sim.candump &
dump=$!
sleep 1
screed sim /screed/experiments/first_drive.ini --can vcan0 --duration 5 --out /tmp/run --quiet || fail "screed sim --can"
sleep 1
kill $dump
frames run/telemetry.log > expected
frames sim.candump > got
[ "$(wc -l < expected)" -gt 500 ] || fail "only $(wc -l < expected) frames in the simulator's own log"
cmp expected got || fail "candump has $(wc -l < got) frames, the simulator's log $(wc -l < expected)"
pass "candump saw all $(wc -l < got) frames of a simulated robot"

echo "guest: $checks checks passed"
end 42
