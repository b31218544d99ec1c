"""python-can's own SLCAN interface at the virtual serial port of a simulated robot: frames come at their rates,
and an emergency stop
written through it stops the robot. Usage: python_can_test.py PORT"""
import sys
import time

import can


def heartbeats_until(bus, seconds, wanted):
    """Collects frames; ends early when a heartbeat (0x010) satisfies wanted(data)."""
    counts, found, end = {}, False, time.monotonic() + seconds
    while time.monotonic() < end and not found:
        message = bus.recv(0.2)
        if message is None:
            continue
        assert not message.is_extended_id and not message.is_remote_frame
        counts[message.arbitration_id] = counts.get(message.arbitration_id, 0) + 1
        found = message.arbitration_id == 0x010 and wanted(message.data)
    return counts, found


def crc8_h2f(data):
    """AUTOSAR CRC8H2F, written from the standard: polynomial 0x2F, initial value and final xor 0xFF."""
    crc = 0xFF
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = ((crc << 1) ^ 0x2F) & 0xFF if crc & 0x80 else crc << 1
    return crc ^ 0xFF


def emergency_stop(counter):
    """E2E profile 2: CRC over the bytes behind it and the id's data id, which is 1 for the id 1."""
    payload = bytes([counter, 0])
    return bytes([crc8_h2f(payload + bytes([1]))]) + payload


bus = can.Bus(interface="slcan", channel=sys.argv[1], ttyBaudrate=57600, bitrate=500000)
heartbeats_until(bus, 1.5, lambda data: False)  # what had piled up before
counts, _ = heartbeats_until(bus, 3.0, lambda data: False)
print({hex(key): count for key, count in sorted(counts.items())})
for frame_id, rate in ((0x010, 5), (0x210, 25), (0x214, 10), (0x310, 10)):
    got = counts.get(frame_id, 0)
    assert 0.6 * 3 * rate <= got <= 1.6 * 3 * rate, f"0x{frame_id:03X}: {got} frames in 3 s, expected {3 * rate}"
for counter in range(3):
    bus.send(can.Message(arbitration_id=0x001, data=emergency_stop(counter), is_extended_id=False))
# Faults are bytes 2 and 3; bit 7: emergency stop. The state, 4: fault, is in the upper half of byte 1.
_, stopped = heartbeats_until(bus, 3.0, lambda data: data[2] & 0x80 and (data[1] >> 4) & 7 == 4)
assert stopped, "the robot did not say that it has stopped"
bus.shutdown()
print("python-can", can.__version__, "received every message at its rate and stopped the robot")
