#!/usr/bin/python3
"""What a frame costs in Python: processor time of the whole client process.

    client/python/benchmarks/frame_cost.py BIN [--rounds=20] [--frames=2000] [--json]

BIN is the folder of tactusd, which is started on a free port of this machine. Three
processes take turns: (a) a client of plain generated stubs, as in
docs/your-first-client.md, (b) tactus.Client, and (c) tactus.Client that packs 8
frames in a message. Each sends a frame of 16 x 24 uint16 with a contact, waits
for its answer, and reads one probability of it; (c) waits for 8 at once. They are
processes because the threads of one grpc channel serve the others of a process.

Prints the mean of the rounds, with the 95 % interval of Student's t, the least of
them, which other work on the machine has disturbed least, and the wall-clock time
of a frame. The package must be installed.
"""

import argparse
import json
import math
import os
import pathlib
import queue
import statistics
import subprocess
import sys
import tempfile
import time

import grpc
import numpy

import tactus
from tactus.v1 import common_pb2, contact_pb2, contact_pb2_grpc

TOUCHED = (180, 181, 204, 205)
PERIOD_NS = 10_000_000


def plain_stubs(address):
    """Yields after each frame."""
    requests = queue.SimpleQueue()
    requests.put(contact_pb2.ClassifyContactRequest(config=contact_pb2.StreamConfig(
        geometry=common_pb2.SensorGeometry(layout="cody-forearm"),
        taxel_type=common_pb2.TAXEL_TYPE_UINT16, scale=0.001)))
    frame = touched_frame()
    with grpc.insecure_channel(address) as channel:
        answers = contact_pb2_grpc.ContactServiceStub(channel).ClassifyContact(
            iter(requests.get, None))
        next(answers)
        sequence = 0
        while True:
            requests.put(contact_pb2.ClassifyContactRequest(frames=contact_pb2.FrameBatch(
                first_sequence=sequence + 1, first_capture_time_ns=PERIOD_NS * sequence,
                frame_count=1, taxels=frame.tobytes())))
            contacts = next(answers).answer.contacts
            probability = contacts[0].answers[0].probability[0] if contacts else None
            sequence += 1
            yield probability


def tactus_client(address, **options):
    frame = touched_frame()
    with tactus.Client(address) as client, client.stream(
            tactus.Skin(name="cody-forearm", scale=0.001), **options) as stream:
        while True:
            probability = None
            for answer in stream.push(frame):
                contact = answer.main
                probability = contact.probability("hardness", "hard") if contact else None
            yield probability


def touched_frame():
    frame = numpy.zeros((16, 24), numpy.uint16)
    frame.reshape(-1)[list(TOUCHED)] = 400
    return frame


def measure(stream, frames):
    """Microseconds of a frame: processor time and wall-clock time."""
    cpu, wall = time.process_time(), time.perf_counter()
    for _ in range(frames):
        next(stream)
    return (1e6 * (time.process_time() - cpu) / frames,
            1e6 * (time.perf_counter() - wall) / frames)


# The 97.5 % quantile of Student's t for 1 to 30 degrees of freedom.
T = (12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228, 2.201, 2.179,
     2.160, 2.145, 2.131, 2.120, 2.110, 2.101, 2.093, 2.086, 2.080, 2.074, 2.069, 2.064,
     2.060, 2.056, 2.052, 2.048, 2.045, 2.042)


def summary(values):
    mean = statistics.fmean(values)
    half = T[min(len(values) - 1, 30) - 1] * statistics.stdev(values) / math.sqrt(len(values))
    return {"mean": mean, "low": mean - half, "high": mean + half, "least": min(values)}


def serve(folder, work):
    port = pathlib.Path(work) / "port"
    server = subprocess.Popen([pathlib.Path(folder) / "tactusd", "--listen=127.0.0.1:0",
                               f"--port-file={port}", "--log-level=error"])
    while not port.exists() or not port.read_text():
        if server.poll() is not None:
            sys.exit("tactusd has ended")
        time.sleep(0.01)
    return server, f"127.0.0.1:{port.read_text().strip()}"


KINDS = {
    "plain stubs": plain_stubs,
    "Client": tactus_client,
    "Client, 8 a message": lambda address: tactus_client(address, frames_per_message=8),
}


def work(kind, address, frames):
    """Measures a round for each line of standard input."""
    stream = KINDS[kind](address)
    measure(stream, max(200, frames // 10))
    for _ in sys.stdin:
        print(json.dumps(measure(stream, frames)), flush=True)
    stream.close()


class Worker:
    def __init__(self, kind, address, frames):
        self.process = subprocess.Popen(
            [sys.executable, __file__, "--work", kind, "--address", address, "--frames",
             str(frames), ""], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)

    def measure(self):
        self.process.stdin.write("\n")
        self.process.stdin.flush()
        return json.loads(self.process.stdout.readline())

    def close(self):
        self.process.stdin.close()
        self.process.wait()
        self.process.stdout.close()


def compare(address, rounds, frames):
    workers = {kind: Worker(kind, address, frames) for kind in KINDS}
    measured = {kind: [] for kind in KINDS}
    for _ in range(rounds):
        for kind, worker in workers.items():
            measured[kind].append(worker.measure())
    for worker in workers.values():
        worker.close()
    return measured


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("bin")
    parser.add_argument("--rounds", type=int, default=20)
    parser.add_argument("--frames", type=int, default=2000)
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--work", help=argparse.SUPPRESS)
    parser.add_argument("--address", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.work:
        work(arguments.work, arguments.address, arguments.frames)
        return
    if arguments.rounds < 2:
        parser.error("--rounds must be 2 or more")
    with tempfile.TemporaryDirectory() as folder:
        server, address = serve(arguments.bin, folder)
        try:
            measured = compare(address, arguments.rounds, arguments.frames)
        finally:
            server.terminate()
            server.wait()
    result = {
        "rounds": arguments.rounds, "frames_per_round": arguments.frames,
        "python": sys.version.split()[0], "grpcio": grpc.__version__,
        "cpus": os.cpu_count(), "load": os.getloadavg()[0],
        "us_per_frame": {kind: {"processor": summary([cpu for cpu, _ in values]),
                                "wall": summary([wall for _, wall in values])}
                         for kind, values in measured.items()}}
    if arguments.json:
        print(json.dumps(result))
        return
    print(f"{arguments.rounds} rounds of {arguments.frames} frames each, Python "
          f"{result['python']}, grpcio {result['grpcio']}, load {result['load']:.1f}")
    print("microseconds a frame: mean and 95 % interval of the rounds, and the least")
    for kind, figures in result["us_per_frame"].items():
        cpu, wall = figures["processor"], figures["wall"]
        print(f"{kind:20} processor {cpu['mean']:6.1f} ({cpu['low']:.1f} to {cpu['high']:.1f}), "
              f"least {cpu['least']:.1f}   wall clock {wall['mean']:6.1f} "
              f"({wall['low']:.1f} to {wall['high']:.1f})")


if __name__ == "__main__":
    main()
