#!/usr/bin/env -S /usr/bin/python3 -B
"""Reads the metrics of a server whose streams are known, and compares.

    metrics_check.py BIN    (the folder of tactusd, tactus-stream and trainctl)

Streams simulated contacts to a tactusd with --metrics while `trainctl streams watch`
looks on. Both texts of /metrics are read by other programs: Debian's prometheus_client
and promtool. Prints what it compared.
"""

import json
import math
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time
import urllib.request

from prometheus_client.openmetrics.parser import text_string_to_metric_families as open_metrics
from prometheus_client.parser import text_string_to_metric_families as text_format

TRIALS = 6
ROBOT = 'arm-7 "left" \\ x'
OPEN_METRICS = "application/openmetrics-text; version=1.0.0"


def check(what, got, want):
    if got != want:
        sys.exit(f"metrics_check: {what}: {got}, not {want}")
    print(f"metrics_check: {what}: {got}")


def metrics_port(log, server):
    """The port that tactusd has written to its log."""
    for _ in range(600):
        found = re.search(r"metrics on .*, port (\d+)", log.read_text())
        if found:
            return int(found.group(1))
        if server.poll() is not None:
            break
        time.sleep(0.05)
    sys.exit(f"metrics_check: tactusd did not start:\n{log.read_text()}")


def scrape(port, accept="text/plain"):
    request = urllib.request.Request(
        f"http://127.0.0.1:{port}/metrics", headers={"Accept": accept}
    )
    with urllib.request.urlopen(request, timeout=20) as response:
        return response.headers["Content-Type"], response.read().decode()


def samples(families):
    return {
        (s.name, tuple(sorted(s.labels.items()))): s.value for f in families for s in f.samples
    }


def total(values, name, **labels):
    wanted = set(labels.items())
    return sum(v for (n, has), v in values.items() if n == name and wanted <= set(has))


def main():
    binaries = pathlib.Path(sys.argv[1]).resolve()
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        address = f"unix:{folder}/s"
        log = folder / "log"
        with open(log, "w", encoding="utf-8") as sink:
            server = subprocess.Popen(
                [
                    binaries / "tactusd",
                    f"--listen={address}",
                    "--metrics=0",
                    "--log-format=json",
                ],
                stderr=sink,
            )
        watch = None
        try:
            port = metrics_port(log, server)
            watch = subprocess.Popen(
                [binaries / "trainctl", "streams", "watch", "--json", f"--server={address}"],
                stdout=subprocess.PIPE,
                text=True,
            )
            # The watch has begun once it is counted.
            for _ in range(400):
                begun = samples(text_format(scrape(port)[1]))
                if total(begun, "grpc_server_started_total", grpc_method="WatchAll") == 1:
                    break
                time.sleep(0.05)
            streamed = subprocess.run(
                [
                    binaries / "tactus-stream",
                    f"--server={address}",
                    f"--trials={TRIALS}",
                    f"--client-id={ROBOT}",
                    "--seed=1",
                    "--json",
                ],
                capture_output=True,
                text=True,
                check=True,
            )
            result = json.loads(streamed.stdout)
            compare(port, result)
            watched(watch, binaries, address)
        finally:
            if watch is not None:
                watch.kill()
                watch.wait()
            server.terminate()
            server.wait()
        lines = [json.loads(line) for line in log.read_text().splitlines()]
        told = [line["message"] for line in lines if "arm-7" in line["message"]]
        check("lines of the log about the stream", len(told), 2)
        print(f"metrics_check: {told[0]}\nmetrics_check: {told[1]}")


def compare(port, result):
    kind, text = scrape(port)
    if not kind.startswith("text/plain"):
        sys.exit(f"metrics_check: Content-Type {kind}")
    values = samples(text_format(text))
    kind, opened = scrape(port, OPEN_METRICS)
    if not kind.startswith("application/openmetrics-text"):
        sys.exit(f"metrics_check: Content-Type {kind}")
    other = samples(open_metrics(opened))
    differing = [
        key
        for key in values
        if key in other and not math.isclose(values[key], other[key], rel_tol=1e-12)
    ]
    check("series that differ between the formats", differing, [])
    check("series that only one format has", set(values) ^ set(other), set())
    check("frames", total(values, "tactus_frames_total"), result["frames"])
    check(
        "frames in the histogram",
        total(values, "tactus_frame_processing_seconds_count"),
        result["frames"],
    )
    check("lost frames", total(values, "tactus_frames_missing_total"), 0)
    check("open streams", total(values, "tactus_streams"), 0)
    check(
        "streams that ended with OK",
        total(
            values,
            "grpc_server_handled_total",
            grpc_method="ClassifyContact",
            grpc_code="OK",
        ),
        total(values, "tactus_streams_opened_total"),
    )
    ended = total(values, "tactus_contacts_total") + total(values, "tactus_contacts_unknown_total")
    check("contacts that ended", ended, total(values, "tactus_contacts_begun_total"))
    if not 1 <= ended:
        sys.exit("metrics_check: no contact was felt")
    labels = {name for (_, has) in values for name, _ in has}
    check("labels that name robots", labels & {"robot", "client", "peer", "stream"}, set())
    promtool = shutil.which("promtool")
    if promtool is None:
        print("metrics_check: promtool is not installed")
        return
    run = subprocess.run(
        [promtool, "check", "metrics"], input=text, capture_output=True, text=True, check=False
    )
    check("what promtool says", (run.returncode, run.stdout + run.stderr), (0, ""))


def watched(watch, binaries, address):
    """What `trainctl streams watch --json` has printed."""
    kinds = []
    for line in watch.stdout:
        update = json.loads(line)
        if "opened" in update:
            check("robot that is watched", update["opened"]["client_id"], ROBOT)
        kinds += [event["event"]["kind"] for event in update.get("events", [])]
        if update["ended"]:
            break
    check(
        "contacts that the watcher saw begin and end",
        kinds.count("touched"),
        kinds.count("released"),
    )
    if not kinds:
        sys.exit("metrics_check: the watcher saw nothing")
    listed = subprocess.run(
        [binaries / "trainctl", "streams", "list", "--json", f"--server={address}"],
        capture_output=True,
        text=True,
        check=True,
    )
    check("streams that are listed", json.loads(listed.stdout), [])


if __name__ == "__main__":
    main()
