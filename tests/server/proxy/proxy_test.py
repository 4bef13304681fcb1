#!/usr/bin/python3
"""tactusd behind HAProxy with deploy/haproxy.cfg: what a stranger's bytes end or
swell without the proxy, they must not with it, and robots are served meanwhile.

  proxy_test.py TACTUSD

The attacker calls from 127.0.0.2 and the bystander from 127.0.0.1, because the
proxy limits each host.
"""

import os
import re
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import time
import unittest

SOURCE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "..")
HEALTH = "/grpc.health.v1.Health/Check"
WATCH = "/grpc.health.v1.Health/Watch"
CLASSIFY = "/tactus.v1.ContactService/ClassifyContact"
LIST_MODELS = "/tactus.v1.ModelService/ListModelVersions"
DATA, HEADERS, RESET, SETTINGS, PING, CONTINUATION = 0, 1, 3, 4, 6, 9
END_STREAM, END_HEADERS = 1, 4
NO_MESSAGE = b"\0\0\0\0\0"
# Every header that gRPC 1.51 gives a meaning.
SPECIAL = """grpc-timeout grpc-encoding grpc-accept-encoding
  grpc-internal-encoding-request grpc-internal-stream-encoding-request
  grpc-previous-rpc-attempts grpc-retry-pushback-ms grpc-server-stats-bin
  grpc-trace-bin grpc-tags-bin lb-token lb-cost-bin grpclb_client_stats
  x-endpoint-load-metrics-bin endpoint-load-metrics-bin grpc-status grpc-message
  content-type te user-agent host :scheme :method :authority :path
  :status""".split()
STRANGE = [b"abc", b"", b"\xff\xfe", b"9" * 20, b"-1", b"AAAA", b"!!!!"]


def varint(value):
    out = b""
    while value >= 128:
        out += bytes([128 | value & 127])
        value >>= 7
    return out + bytes([value])


def text(value):
    value = value if isinstance(value, bytes) else value.encode()
    if len(value) < 127:
        return bytes([len(value)]) + value
    return b"\x7f" + varint(len(value) - 127) + value


def field(name, value):
    """An HPACK literal that stays out of the table."""
    return b"\0" + text(name) + text(value)


def call(path, *more):
    """The headers of a call."""
    fields = [(":method", "POST"), (":scheme", "http"), (":path", path),
              (":authority", "x"), ("content-type", "application/grpc"),
              ("te", "trailers"), *more]
    return b"".join(field(name, value) for name, value in fields)


def frame(kind, flags, stream, payload=b""):
    return struct.pack(">I", len(payload))[1:] + struct.pack(">BBI", kind, flags, stream) + payload


def frames(received):
    at = 0
    while at + 9 <= len(received):
        size = int.from_bytes(received[at:at + 3], "big")
        stream = int.from_bytes(received[at + 5:at + 9], "big")
        yield received[at + 3], received[at + 4], stream, received[at + 9:at + 9 + size]
        at += 9 + size


class Connection:
    """Writes frames; a peer that does not read for 5 s counts as closed."""

    def __init__(self, port, host="127.0.0.2", buffer=None):
        self.socket = socket.socket()
        if buffer is not None:
            self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, buffer)
        self.socket.settimeout(5)
        self.socket.bind((host, 0))
        try:
            self.socket.connect(("127.0.0.1", port))
        except OSError:
            self.socket.close()
            raise
        self.send(b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n" + frame(SETTINGS, 0, 0))

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.socket.close()

    def send(self, data):
        """False if the peer has closed the connection, or does not read."""
        try:
            self.socket.sendall(data)
            return True
        except OSError:
            return False

    def unary(self, headers, trailers=None):
        """The frames of the answer to one call without a message."""
        self.send(frame(HEADERS, END_HEADERS, 1, headers))
        if trailers is None:
            self.send(frame(DATA, END_STREAM, 1, NO_MESSAGE))
        else:
            self.send(frame(DATA, 0, 1, NO_MESSAGE) +
                      frame(HEADERS, END_STREAM | END_HEADERS, 1, trailers))
        received = b""
        try:
            while not any(stream == 1 and (kind == RESET or kind in (DATA, HEADERS) and
                                           flags & END_STREAM)
                          for kind, flags, stream, _ in frames(received)):
                more = self.socket.recv(65536)
                if not more:
                    break
                received += more
        except OSError:
            pass
        return received


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


class Bystander(threading.Thread):
    """Asks for the server's health all the time, each time on a new connection."""

    def __init__(self, port):
        super().__init__()
        self.port, self.done, self.waits, self.failed = port, False, [], []

    def healthy(self):
        with Connection(self.port, "127.0.0.1") as connection:
            answer = connection.unary(call(HEALTH))
        healthy = any(kind == DATA and payload == b"\0\0\0\0\2\x08\x01"
                      for kind, _, _, payload in frames(answer))
        if not healthy:
            self.failed.append(list(frames(answer)))
        return healthy

    def run(self):
        while not self.done:
            begin = time.monotonic()
            try:
                self.healthy()
            except OSError as error:
                self.failed.append(error)
            self.waits.append(time.monotonic() - begin)
            time.sleep(0.05)


class ProxyTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        port_file = os.path.join(cls.scratch.name, "port")
        cls.server = subprocess.Popen(
            [sys.argv[1], "--listen=127.0.0.1:0", f"--port-file={port_file}", "--behind-proxy",
             f"--data-dir={cls.scratch.name}/data", "--log-level=error"])
        for _ in range(600):
            if os.path.exists(port_file):
                break
            time.sleep(0.05)
        with open(port_file, encoding="ascii") as file:
            behind = int(file.read())
        cls.port = free_port()
        with open(os.path.join(SOURCE, "deploy", "haproxy.cfg"), encoding="utf-8") as file:
            configuration = file.read()
        configuration = re.sub(r":50052\b", f":{behind}", configuration)
        configuration = re.sub(r":50051\b", f":{cls.port}", configuration)
        path = os.path.join(cls.scratch.name, "haproxy.cfg")
        with open(path, "w", encoding="utf-8") as file:
            file.write(configuration)
        cls.proxy = subprocess.Popen(
            ["/usr/sbin/haproxy", "-f", path],
            env={**os.environ, "TACTUS_BIND": "127.0.0.1"}, stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL)
        probe = Bystander(cls.port)
        for _ in range(300):
            try:
                if probe.healthy():
                    return
            except OSError:
                pass
            time.sleep(0.1)
        raise AssertionError("the proxy does not serve")

    @classmethod
    def tearDownClass(cls):
        cls.proxy.kill()
        cls.proxy.wait()
        cls.server.send_signal(signal.SIGTERM)
        ended = cls.server.wait(timeout=60)
        cls.scratch.cleanup()
        if ended != 0:
            raise AssertionError(f"tactusd ended with {ended}")

    def setUp(self):
        self.bystander = Bystander(self.port)
        self.bystander.start()

    def tearDown(self):
        self.bystander.done = True
        self.bystander.join()
        peak = {name: self.megabytes(process)
                for name, process in (("tactusd", self.server), ("haproxy", self.proxy))}
        print(f"{self.id().rsplit('.', 1)[-1]}: bystander waits at most "
              f"{1000 * max(self.bystander.waits):.0f} ms; peaks {peak}")
        self.assertIsNone(self.server.poll(), "the attack ended tactusd")
        self.assertIsNone(self.proxy.poll(), "the attack ended HAProxy")
        self.assertEqual(self.bystander.failed, [], "a bystander was not served")
        for name, megabytes in peak.items():
            self.assertLess(megabytes, 150, name)

    @staticmethod
    def megabytes(process):
        """Most memory since the start."""
        with open(f"/proc/{process.pid}/status", encoding="ascii") as file:
            return int(re.search(r"VmHWM:\s*(\d+)", file.read())[1]) // 1000

    def test_headers_that_grpc_treats_specially(self):
        for name in SPECIAL:
            for value in STRANGE:
                with Connection(self.port) as connection:
                    connection.unary(call(HEALTH, (name, value)))

    def test_the_same_as_trailers(self):
        for path in (HEALTH, CLASSIFY):
            for name in SPECIAL:
                with Connection(self.port) as connection:
                    connection.unary(call(path), trailers=field(name, "abc"))

    def test_a_value_of_4_gib(self):
        with Connection(self.port) as connection:
            self.flood(connection, call(HEALTH) + b"\0\3abc\x7f\x81\xff\xff\xff\x0f", b"a" * 16384)

    def test_an_integer_without_end(self):
        with Connection(self.port) as connection:
            self.flood(connection, call(HEALTH) + b"\0\x7f", b"\x80" * 16384)

    def test_continuation_flood(self):
        with Connection(self.port) as connection:
            self.flood(connection, call(HEALTH), field("a", "b") * 2000)

    def flood(self, connection, begin, more):
        """Headers without end: the proxy must not take 15 MB of them."""
        connection.send(frame(HEADERS, 0, 1, begin))
        for _ in range(15_000_000 // len(more)):
            if not connection.send(frame(CONTINUATION, 0, 1, more)):
                return
        self.fail("the proxy takes headers without end")

    def test_rapid_reset(self):
        with Connection(self.port) as connection:
            for i in range(10_000):
                stream = 2 * i + 1
                if not connection.send(frame(HEADERS, END_HEADERS, stream, call(CLASSIFY)) +
                                       frame(RESET, 0, stream, b"\0\0\0\x08")):
                    break

    def test_streams_that_nobody_reads(self):
        connections = [Connection(self.port, buffer=1024) for _ in range(16)]
        for connection in connections:
            for i in range(62):
                connection.send(frame(HEADERS, END_HEADERS, 2 * i + 1, call(WATCH)) +
                                frame(DATA, END_STREAM, 2 * i + 1, NO_MESSAGE))
        for connection in connections:
            connection.socket.close()

    def test_answers_that_nobody_reads(self):
        for flood in (frame(PING, 0, 0, b"12345678"), frame(SETTINGS, 0, 0, b"\0\3\0\0\0\x64")):
            with Connection(self.port, buffer=1024) as connection:
                connection.socket.settimeout(0.5)
                for _ in range(200):
                    if not connection.send(flood * 1000):
                        break

    def test_a_stranger_may_only_classify(self):
        # Without tokens; on the server's own loopback, a caller could do all.
        with Connection(self.port) as connection:
            answer = connection.unary(call(LIST_MODELS))
        self.assertIn(b"grpc-status\x0216", answer)
        with Connection(self.port) as connection:
            answer = connection.unary(call("/no.such.Service/Call"))
        self.assertNotIn(b"grpc-status", answer)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
