"""A real server for the tests, and frames for it."""

import os
import pathlib
import signal
import socket
import subprocess
import tempfile
import time

import numpy

import tactus

BIN = pathlib.Path(os.environ["TACTUS_BIN"])
ROOT = pathlib.Path(__file__).resolve().parents[3]
FOREARM = tactus.Skin(name="cody-forearm", scale=0.001)


def free_port():
    with socket.socket() as s:
        s.bind(("127.0.0.1", 0))
        return s.getsockname()[1]


class Server:
    """tactusd, on one port for all its lives."""

    def __init__(self, *flags):
        self.folder = tempfile.TemporaryDirectory(prefix="tactus-python-")
        self.path = pathlib.Path(self.folder.name)
        self.port = free_port()
        self.address = f"127.0.0.1:{self.port}"
        self.flags = [flag.replace("FOLDER", self.folder.name) for flag in flags]
        self.process = None
        self.start()

    def start(self):
        ready = self.path / "port"
        ready.unlink(missing_ok=True)
        self.process = subprocess.Popen(
            [BIN / "tactusd", f"--listen={self.address}", f"--port-file={ready}",
             "--log-level=error", *self.flags])
        while not ready.exists() or not ready.read_text():
            if self.process.poll() is not None:
                raise RuntimeError("tactusd has ended")
            time.sleep(0.01)

    def kill(self):
        """As kill -9."""
        self.process.send_signal(signal.SIGKILL)
        self.process.wait()

    def stop(self):
        if self.process.poll() is None:
            self.process.kill()
            self.process.wait()
        self.folder.cleanup()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.stop()


def run(program, *arguments, **environment):
    """Runs a program of the build and returns what it prints."""
    done = subprocess.run([BIN / program, *map(str, arguments)], capture_output=True, text=True,
                          env={**os.environ, **environment})
    if done.returncode != 0:
        raise RuntimeError(f"{program} {arguments}: {done.stdout}{done.stderr}")
    return done.stdout


def touch(frames, taxels=(180, 181, 204, 205), start=0, dtype="uint16"):
    """A touch of the forearm that grows: [frames, 16, 24] millinewtons."""
    made = numpy.zeros((frames, 16, 24), dtype)
    made.reshape(frames, -1)[:, taxels] = (20 * numpy.maximum(
        0, numpy.arange(frames) - start))[:, None]
    return made


def words(answer):
    """All that an answer says, to compare bit for bit."""
    return repr(answer).encode()
