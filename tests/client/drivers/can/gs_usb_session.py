"""Writes gs_usb_session.pcap, a session of libusb with a gs_usb adapter.

    python3 gs_usb_session.py gs_usb_session.pcap

The file is one that usbmon would have recorded (link type 220, 64-byte headers)
of device 7 on bus 1. Layouts and numbers are those of the kernel's
Documentation/usb/usbmon.rst and drivers/net/can/usb/gs_usb.c, and none of them
is taken from our driver. The adapter has a clock of 48 MHz and time stamps.

The host sets the adapter up for 1 Mbit/s, queues 30 transfers, receives FRAMES
frames, sends one, gets its echo, and receives frames again. There is no reset
at the end: umockdev passes over a control transfer that does not come at once.
"""

import struct
import sys

BUS, DEVICE = 1, 7
CONTROL, BULK = 2, 3
TRANSFERS = 30
FRAMES = 40
NO_ECHO = 0xFFFFFFFF
EXTENDED, ERROR = 1 << 31, 1 << 29


class Capture:
    def __init__(self):
        # Microseconds, link type 220.
        self.bytes = struct.pack("<IHHiIII", 0xA1B2C3D4, 2, 4, 0, 0, 65535, 220)
        self.time_us = 1_700_000_000_000_000
        self.next_id = 0xFFFF_8880_0000_1000

    def packet(self, event, urb, kind, endpoint, length, data, setup=None,
               status=0):
        self.time_us += 125
        seconds, micros = divmod(self.time_us, 1_000_000)
        data_flag = 0 if data else ord("<" if endpoint & 0x80 else ">")
        header = struct.pack(
            "<QBBBBHBBqiiII8siiII", urb, ord(event), kind, endpoint, DEVICE,
            BUS, ord("-") if setup is None else 0, data_flag, seconds, micros,
            status, length, len(data), setup or bytes(8), 0, 0, 0, 0)
        assert len(header) == 64
        self.bytes += struct.pack("<IIII", seconds, micros,
                                  64 + len(data), 64 + len(data))
        self.bytes += header + data

    def new_id(self):
        self.next_id += 0x100
        return self.next_id

    def control_out(self, request, value, data):
        urb = self.new_id()
        setup = struct.pack("<BBHHH", 0x41, request, value, 0, len(data))
        self.packet("S", urb, CONTROL, 0x00, len(data), data, setup, -115)
        self.packet("C", urb, CONTROL, 0x00, len(data), b"")

    def control_in(self, request, value, data):
        urb = self.new_id()
        setup = struct.pack("<BBHHH", 0xC1, request, value, 0, len(data))
        self.packet("S", urb, CONTROL, 0x80, len(data), b"", setup, -115)
        self.packet("C", urb, CONTROL, 0x80, len(data), data)

    def submit_in(self, urb):
        self.packet("S", urb, BULK, 0x81, 64, b"", None, -115)

    def complete_in(self, urb, data):
        self.packet("C", urb, BULK, 0x81, len(data), data)
        self.submit_in(urb)

    def bulk_out(self, data):
        urb = self.new_id()
        self.packet("S", urb, BULK, 0x02, len(data), data, None, -115)
        self.packet("C", urb, BULK, 0x02, len(data), b"")


def host_frame(echo, can_id, data, stamp_us=None, flags=0):
    frame = struct.pack("<IIBBBB8s", echo, can_id, len(data), 0, flags, 0,
                        bytes(data).ljust(8, b"\0"))
    return frame if stamp_us is None else frame + struct.pack("<I", stamp_us)


def session():
    capture = Capture()
    capture.control_out(2, 0, struct.pack("<II", 0, 0))
    capture.control_out(0, 1, struct.pack("<I", 0xBEEF))
    capture.control_in(5, 1, struct.pack("<BBBBII", 0, 0, 0, 0, 2, 1))
    # Features: listen-only, loopback, one-shot, time stamps, identify.
    capture.control_in(4, 0, struct.pack("<10I", 0x3B, 48_000_000, 1, 16, 1, 8,
                                         4, 1, 1024, 1))
    capture.control_out(1, 0, struct.pack("<5I", 1, 12, 2, 1, 3))
    urbs = [capture.new_id() for _ in range(TRANSFERS)]
    for urb in urbs:
        capture.submit_in(urb)
    capture.control_out(2, 0, struct.pack("<II", 1, 1 << 4))
    received = 0

    def receive(data):
        nonlocal received
        capture.complete_in(urbs[received % TRANSFERS], data)
        received += 1

    for i in range(FRAMES):
        receive(host_frame(NO_ECHO, 0x4D0 + i % 16, [0x40, i, 2, 3, 4, 5, 6, 7],
                           0xFFFFFFFF - 20 * 130 + i * 130 & 0xFFFFFFFF))
    # An error frame (error passive), a frame that lost others before it, and
    # one with an identifier of 29 bits.
    receive(host_frame(NO_ECHO, ERROR | 0x4, [0, 0x10, 0, 0, 0, 0, 96, 0], 3000))
    receive(host_frame(NO_ECHO, 0x4C1, [1], 3200, flags=1))
    receive(host_frame(NO_ECHO, EXTENDED | 0x12345, [9, 8], 3400))
    capture.bulk_out(host_frame(0, 0x20D, [7, 0]))
    receive(host_frame(0, 0x20D, [7, 0], 3600))
    for i in range(FRAMES):
        receive(host_frame(NO_ECHO, 0x4C0, [0xC0, i, 0, 0, 0, 0, 0, 0],
                           4000 + i * 130))
    return capture.bytes


if __name__ == "__main__":
    with open(sys.argv[1], "wb") as file:
        file.write(session())
