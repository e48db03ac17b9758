"""Listens on a CAN interface with python3-can and tells the last positions that RMD drives were sent to.

Usage: witness.py INTERFACE, until SIGTERM. Decoded here from the makers' document: command 0xA4, bytes 4 to 7 the angle in
0.01 degree, little endian, signed."""
import signal
import struct
import sys

import can

ended = []
signal.signal(signal.SIGTERM, lambda *_: ended.append(True))
bus = can.Bus(interface="socketcan", channel=sys.argv[1])
print("listening", flush=True)
angles = {}
frames = 0
while not ended:
    message = bus.recv(timeout=0.5)
    if message is None:
        continue
    frames += 1
    if message.arbitration_id in (0x141, 0x142) and message.data[0] == 0xA4:
        angles[message.arbitration_id] = struct.unpack_from("<i", message.data, 4)[0] / 100.0
print('{"frames": %d, "pan_deg": %s, "tilt_deg": %s}' % (frames, angles.get(0x141), angles.get(0x142)))
