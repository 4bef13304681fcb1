"""Runs the snippets of docs/python.md, one after the other, as they stand."""

import contextlib
import io
import json
import os
import re
import tempfile
import unittest

from support import ROOT, Server

try:
    from tactus import _native
except ImportError:
    _native = None

PAGE = (ROOT / "docs/python.md").read_text()


def calibration():
    """What cal.json of the page has."""
    return {
        "format": "tactus-calibration", "version": 1, "device": "page",
        "layout": {"layout": "my-palm", "rows": 8, "columns": 8, "row_pitch_m": 0.005,
                   "column_pitch_m": 0.005, "taxel_area_m2": 25e-6,
                   "unit": "TAXEL_UNIT_NEWTON", "contact_threshold": 0.01,
                   "onset_threshold": 0.02},
        "created_ms": 0, "frames": 300, "sample_rate_hz": 100.0, "baseline": [200.0] * 64,
        "deviation": [0.5] * 64, "contact_threshold": [3.0] * 64, "onset_threshold": [6.0] * 64,
        "gains": [], "dead": [], "stuck": [], "noisy": []}


class PageTest(unittest.TestCase):
    def test_commands_are_those_that_tests_run(self):
        tests = (ROOT / "client/python/tests/run.sh").read_text()
        for command in re.findall(r"<!-- run by client/python/tests/run.sh -->\n```sh\n(.*?)```",
                                  PAGE, re.DOTALL)[0].splitlines():
            words = [word for word in command.split() if word.startswith("-")]
            for word in words:
                self.assertIn(word, tests, command)

    def test_snippets(self):
        flags = re.search(r"^tactusd (.*) &$", PAGE, re.MULTILINE).group(1).split()
        flags = [flag.replace("tactus-data", "FOLDER/data") for flag in flags
                 if not flag.startswith("--listen")]
        snippets = [snippet for native, snippet in re.findall(
            r"^(<!-- needs the compiled module -->\n)?```python\n(.*?)^```$", PAGE,
            re.MULTILINE | re.DOTALL) if _native or not native]
        self.assertGreater(len(snippets), 12 if _native else 8)
        printed = io.StringIO()
        before = os.getcwd()
        with Server(*flags) as server, tempfile.TemporaryDirectory() as folder:
            os.environ["TACTUS_SERVER"] = server.address
            os.chdir(folder)
            try:
                with open("cal.json", "w") as file:
                    json.dump(calibration(), file)
                space = {"__name__": "page"}
                with contextlib.redirect_stdout(printed), \
                        contextlib.redirect_stderr(io.StringIO()):
                    for i, snippet in enumerate(snippets):
                        exec(compile(snippet, f"docs/python.md, snippet {i}", "exec"), space)
                space["client"].close()
            finally:
                os.chdir(before)
                del os.environ["TACTUS_SERVER"]
        text = printed.getvalue()
        self.assertIn(re.search(r"```text\n(.*?)```", PAGE, re.DOTALL).group(1), text)
        for word in ("models/palm/versions/1", "DATASET_NOT_FOUND", "hard soft"):
            self.assertIn(word, text)


if __name__ == "__main__":
    unittest.main()
