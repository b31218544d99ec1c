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
touch monitor.txt

# Lines of a candump log without time and interface.
frames() { sed -n 's/^([0-9.]*) [^ ]* //p' "$1"; }

# --- the simulator's frames on vcan, as candump sees them -------------------------------------------------------------
candump -r 4194304 -d -L vcan0 > sim.candump &
dump=$!
sleep 1
screed sim first_drive --can vcan0 --duration 5 --out /tmp/run --quiet || fail "screed sim --can"
sleep 1
kill $dump
frames run/telemetry.log > expected
frames sim.candump > got
[ "$(wc -l < expected)" -gt 500 ] || fail "only $(wc -l < expected) frames in the simulator's own log"
cmp expected got || fail "candump has $(wc -l < got) frames, the simulator's log $(wc -l < expected)"
pass "candump saw all $(wc -l < got) frames of a simulated robot"

# --- screed monitor reads what cansend wrote --------------------------------------------------------------------------
screed monitor --can vcan0 --listen --plain --duration 5 --log monitor.candump > monitor.txt &
monitor=$!
until grep -q 'link vcan0 is up' monitor.txt; do sleep 0.2; done
# A heartbeat, and an attitude of 12.34, -5 and 90 degrees, with their checksums; the same with one wrong bit; something
# foreign.
for frame in 010#1103000007000000 210#AE03D2040CFE2823 210#AF03D2040CFE2823 7FF#01; do cansend vcan0 $frame; done
wait $monitor || fail "screed monitor ended with $?"
grep -q 'attitude: roll 12.34 deg pitch -5.00 deg heading 90.00 deg' monitor.txt \
  || { cat monitor.txt; fail "cansend's frame is not shown"; }
grep -q '4 frames, 1 damaged, 1 unknown' monitor.txt \
  || { cat monitor.txt; fail "damaged and unknown frames are not counted"; }
frames monitor.candump | head -n 4 | tr '\n' ' ' > got
grep -q '^010#1103000007000000 210#AE03D2040CFE2823 210#AF03D2040CFE2823 7FF#01 $' got \
  || { cat got; fail "the monitor's log differs"; }
pass "screed monitor shows and logs what cansend wrote, and counts what is damaged"
canplayer -I monitor.candump vcan0=vcan0 || fail "canplayer does not read the monitor's log"
pass "canplayer plays the monitor's log"

# --- a controller goes bus off and restarts: error frames as its driver writes them, since vcan has no errors of its
# own ------------
shown() { # text, times
  for attempt in $(seq 60); do
    [ "$(grep -c "$1" monitor.txt)" -ge "$2" ] && return
    sleep 0.2
  done
  cat monitor.txt
  fail "the monitor does not say: $1"
}
screed monitor --can vcan0 --listen --plain --duration 60 > monitor.txt &
monitor=$!
shown 'link vcan0 is up' 1
cansend vcan0 20000040#0000000000000000
shown 'bus off' 1
cansend vcan0 20000100#0000000000000000
shown 'link vcan0 is up' 2
cansend vcan0 20000040#0000000000000000
shown 'bus off' 2
ip link set vcan0 down
shown 'is down (ip link' 1
ip link set vcan0 up
shown 'link vcan0 is up' 3
kill -INT $monitor
wait $monitor
pass "screed monitor tells of bus off, of the restart, and of an interface that was set up anew by hand"

# --- the interface goes down and up under simulator and monitor -------------------------------------------------------
screed sim first_drive --can vcan0 --duration 90 --out /tmp/run2 --quiet > /dev/null &
sim=$!
screed monitor --can vcan0 --plain --listen --duration 35 > monitor.txt &
monitor=$!
until grep -q 'robot 1: ' monitor.txt; do sleep 0.5; done
ip link set vcan0 down
sleep 2
grep -q 'is down' monitor.txt || { cat monitor.txt; fail "the monitor does not say that the interface is down"; }
ip link set vcan0 up
sleep 3
before=$(sed -n 's/.*, \([0-9]*\) frames, [0-9]* lost/\1/p' monitor.txt | tail -n 1)
sleep 3
after=$(sed -n 's/.*, \([0-9]*\) frames, [0-9]* lost/\1/p' monitor.txt | tail -n 1)
[ "${after:-0}" -gt "${before:-0}" ] \
  || { cat monitor.txt; fail "no frames after the interface came back ($before, $after)"; }
pass "simulator and monitor go on after the interface was down ($before frames, then $after)"
# The interface is taken away and made anew.
ip link del vcan0
sleep 1
ip link add dev vcan0 type vcan && ip link set vcan0 up
sleep 4
after=$(sed -n 's/.*, \([0-9]*\) frames, [0-9]* lost/\1/p' monitor.txt | tail -n 1)
sleep 4
again=$(sed -n 's/.*, \([0-9]*\) frames, [0-9]* lost/\1/p' monitor.txt | tail -n 1)
[ "$again" -gt "$after" ] || { cat monitor.txt; fail "no frames after the interface was made anew ($after, $again)"; }
pass "and after it was taken away and made anew ($again)"

# --- screed param and send, and the robot's answer --------------------------------------------------------------------
screed param get --can vcan0 climb_speed > sent.txt || { cat sent.txt; fail "screed param get: $?"; }
grep -q 'climb_speed = 200 mm/s' sent.txt || { cat sent.txt; fail "wrong parameter"; }
screed send --can vcan0 disarm > sent.txt || { cat sent.txt; fail "screed send disarm failed"; }
screed param set --can vcan0 climb_speed 150 > sent.txt || { cat sent.txt; fail "screed param set failed"; }
screed param get --can vcan0 climb_speed > sent.txt || { cat sent.txt; fail "screed param get: $?"; }
grep -q 'climb_speed = 150 mm/s' sent.txt || { cat sent.txt; fail "the parameter was not written"; }
screed send --can vcan0 estop > sent.txt || { cat sent.txt; fail "screed send estop: $?"; }
grep -q 'robot 1 has stopped' sent.txt || { cat sent.txt; fail "no word of the stop"; }
status=0
screed send --can vcan0 run > sent.txt || status=$?
[ $status -eq 1 ] || fail "a refused command ended with $status"
grep -q 'run: refused: ' sent.txt || { cat sent.txt; fail "no reason for the refusal"; }
pass "screed param and send: a parameter read and written, an emergency stop, and a refusal: $(cat sent.txt)"
kill -INT $monitor $sim
wait $monitor $sim

# --- slcand makes the virtual serial port a CAN interface -------------------------------------------------------------
screed sim first_drive --pty /dev/radio --duration 20 --out /tmp/run3 --quiet > /dev/null &
sim=$!
while [ ! -e /dev/radio ]; do sleep 0.2; done
slcand -o -c -s6 radio slcan0 || fail "slcand: $?"
for wait in 1 2 3 4 5; do ip link set slcan0 up 2> /dev/null && break; sleep 1; done
candump -r 4194304 -d -L slcan0 > slcan.candump &
dump=$!
sleep 6
cansend slcan0 001#B70100 || fail "cansend on slcan0"
sleep 4
kill $dump
frames slcan.candump > got
[ "$(wc -l < got)" -gt 400 ] || fail "only $(wc -l < got) frames through slcand"
grep -q "^010#....80" got || { tail -n 3 got; fail "the emergency stop of cansend did not reach the robot"; }
pass "slcand: $(wc -l < got) frames, and cansend stops the robot"
kill $sim
wait $sim
# Whatever slcand brought, the simulator's ground station has in its log, in that order, but for frames that change
# places with the one to three before them: the kernel's slcan hands frames to the network layer on whichever processor
# is free.
frames run3/telemetry.log > expected
grep -v '^001#' got > checked
awk 'NR == FNR { log_line[n++] = $0; next }
  { for (at = next_one > 3 ? next_one - 3 : 0; at < n && (at in used || log_line[at] != $0); at++);
    if (at == n) { print "line " FNR ": " $0; exit 1 }
    used[at] = 1
    if (at >= next_one) next_one = at + 1 }' expected checked > missing || {
  cat missing
  line=$(sed 's/line \([0-9]*\).*/\1/' missing)
  grep -n "" checked | sed -n "$((line > 5 ? line - 5 : 1)),$((line + 5))p"
  echo "the log:"
  grep -n -A 12 -F "$(sed -n "$((line - 1))p" checked)" expected
  fail "a frame through slcand is not the simulator's"
}
pass "they are the simulator's, in its order"

echo "guest: $checks checks passed"
end 42
