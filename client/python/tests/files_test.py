"""Trial files, pictures, doctests, types."""

import doctest
import importlib
import importlib.util
import json
import pathlib
import pkgutil
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree

import numpy

import tactus
from support import BIN, FOREARM, ROOT, Server, run, touch


def has(package):
    return importlib.util.find_spec(package) is not None


@unittest.skipUnless(has("h5py"), "needs h5py")
class RecordingTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        cls.path = pathlib.Path(cls.folder.name)
        run("trainctl", "simulate", "--protocol=random", "--contacts=3", "--skin=good",
            "--seed=2", f"--out={cls.path}/a.h5")
        run("trainctl", "simulate", "--protocol=random", "--contacts=3", "--skin=good",
            "--touches=2", "--seed=2", f"--out={cls.path}/several.h5")

    def check_same(self, ours, theirs):
        for a, b in zip(ours, theirs):
            for name in ("taxels", "time", "poses", "signals", "object_motion"):
                self.assertEqual(getattr(a, name) is None, getattr(b, name) is None, name)
                if getattr(a, name) is not None:
                    numpy.testing.assert_array_equal(getattr(a, name), getattr(b, name))
            for name in ("id", "label", "condition", "object", "material", "stiffness",
                         "velocity", "rate_hz", "unit", "skin"):
                self.assertEqual(getattr(a, name), getattr(b, name), name)
            self.assertEqual(len(a.touches), len(b.touches))
            for c, d in zip(a.touches, b.touches):
                for name in ("begin_s", "end_s", "label", "row", "column", "object"):
                    self.assertEqual(getattr(c, name), getattr(d, name), name)

    def test_hdf5_npz_and_what_we_write(self):
        for name in ("a", "several"):
            recording = tactus.Recording(self.path / f"{name}.h5")
            self.assertGreater(len(recording), 0)
            trial = recording[0]
            self.assertEqual(trial.taxels.shape, (trial.frames, 16, 24))
            self.assertEqual(trial.poses.shape, (trial.frames, 7))
            self.assertEqual(trial.skin.name, "cody-forearm")
            run("trainctl", "trials", "export", self.path / f"{name}.h5", "--format=npz",
                f"--out={self.path}/{name}-npz")
            self.check_same(recording, tactus.Recording(self.path / f"{name}-npz"))
            tactus.write_trials(self.path / "ours.h5", recording)
            self.check_same(recording, tactus.Recording(self.path / "ours.h5"))
            run("trainctl", "import", self.path / "ours.h5", f"--out={self.path}/again.h5")
            self.check_same(recording, tactus.Recording(self.path / "again.h5"))
        self.assertTrue(any(trial.touches for trial in recording))

    def test_csv(self):
        (self.path / "b.csv").write_text(
            "# label=HU\n# sample_rate_hz=50\ntime,force,area,motion\n"
            "0,1.5,0.0001,0\n0.02,2.5,0.0002,0.001\n")
        (trial,) = tactus.Recording(self.path / "b.csv")
        self.assertEqual((trial.label, trial.rate_hz, trial.id), ("HU", 50.0, "b"))
        self.assertEqual(trial.signals.tolist(), [[1.5, 0.0001, 0], [2.5, 0.0002, 0.001]])
        run("trainctl", "import", self.path / "b.csv", f"--out={self.path}/csv.h5")
        numpy.testing.assert_array_equal(
            tactus.Recording(self.path / "csv.h5")[0].signals, trial.signals)

    def test_loads_are_rounded_once(self):
        trial = tactus.Recording(self.path / "a.h5")[0]
        right = (trial.taxels.astype(float) * 0.001).astype(numpy.float32)
        numpy.testing.assert_array_equal(trial.loads, right)

    @unittest.skipUnless(has("pandas"), "needs pandas")
    def test_pandas(self):
        recording = tactus.Recording(self.path / "a.h5")
        table = recording.to_pandas()
        self.assertEqual(list(table["label"]), [trial.label for trial in recording])
        frame = recording[0].to_pandas()
        self.assertEqual(frame.index.name, "time_s")
        self.assertEqual(len(frame), recording[0].frames)
        self.assertAlmostEqual(frame["largest"].max(), float(recording[0].loads.max()))

    def test_what_cannot_be_read(self):
        (self.path / "bad.csv").write_text("a,b\n1,2\n")
        (self.path / "bad.h5").write_bytes(b"no HDF5")
        numpy.savez(self.path / "pickle.npz", time=numpy.array([{}], object))
        numpy.savez(self.path / "bare.npz", label="HU")
        for name, reason in (("bad.csv", "TRIAL_FILE_INVALID"), ("bad.h5", "IO"),
                             ("none.npz", "IO"), ("a.txt", "TRIAL_FILE_INVALID"),
                             ("pickle.npz", "TRIAL_FILE_INVALID"),
                             ("bare.npz", "TRIAL_FILE_INVALID")):
            with self.assertRaises(tactus.Error) as caught:
                tactus.Recording(self.path / name)
            self.assertEqual(caught.exception.reason, reason)
            self.assertIn(name, str(caught.exception))


class PictureTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.server = Server()
        cls.addClassCleanup(cls.server.stop)

    def answer(self):
        with tactus.Client(self.server.address) as client, client.stream(FOREARM) as stream:
            for frame in touch(80):
                (answer,) = stream.push(frame)
            return answer, stream._repr_html_()

    def check(self, html):
        """Well-formed, and nothing in it fetches anything."""
        xml.etree.ElementTree.fromstring(html)
        for word in ("<script", "href", "src=", "url(", "@import", "<style", "<image"):
            self.assertNotIn(word, html)
        addresses = set(re.findall(r"https?://[^\"]*", html))
        self.assertLessEqual(addresses, {"http://www.w3.org/2000/svg"})

    def test_html(self):
        answer, stream = self.answer()
        html = answer._repr_html_()
        self.check(html)
        self.check(stream)
        self.check(answer.main._repr_html_())
        self.assertEqual(html.count("<svg"), 5)
        self.assertIn("hardness", html)
        # Four taxels are touched, by the same load, the darkest.
        self.assertEqual(html.count("#08306b"), 4)

    def test_names_are_escaped(self):
        import dataclasses

        answer, _ = self.answer()
        evil = "<script>alert(1)</script>\"'&"
        contact = dataclasses.replace(answer.main, classes={evil: 0.5, "b": float("nan")})
        answer = dataclasses.replace(
            answer, contacts=(contact,), skin=answer.skin.replace(name=evil))
        self.check(answer._repr_html_())
        self.assertIn("&lt;script&gt;", answer._repr_html_())

    @unittest.skipUnless(has("matplotlib"), "needs matplotlib")
    def test_plot(self):
        import matplotlib

        matplotlib.use("Agg")
        answer, _ = self.answer()
        skin, bars = answer.plot()
        self.assertEqual(len(bars.patches), 8)
        self.assertIn("cody-forearm", skin.get_title())
        with tempfile.NamedTemporaryFile(suffix=".png") as file:
            skin.figure.savefig(file.name)
            self.assertGreater(pathlib.Path(file.name).stat().st_size, 1000)


class CodeTest(unittest.TestCase):
    def test_examples_in_docstrings(self):
        tried = 0
        for module in pkgutil.iter_modules(tactus.__path__, "tactus."):
            if module.name == "tactus.v1":
                continue
            result = doctest.testmod(importlib.import_module(module.name))
            self.assertEqual(result.failed, 0, module.name)
            tried += result.attempted
        self.assertEqual(doctest.testmod(tactus).failed, 0)
        self.assertGreater(tried, 10)

    def test_the_benchmark_runs(self):
        done = subprocess.run(
            [sys.executable, ROOT / "client/python/benchmarks/frame_cost.py", BIN, "--rounds=2",
             "--frames=100", "--json"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        figures = json.loads(done.stdout)["us_per_frame"]
        self.assertEqual(list(figures), ["plain stubs", "Client", "Client, 8 a message"])
        for figure in figures.values():
            self.assertGreater(figure["processor"]["mean"], 0)

    def test_calibrations_that_the_cpp_client_reads(self):
        files = sorted((ROOT / "tests/fuzz/corpus/calibration").glob("good*.json"))
        self.assertTrue(files)
        for file in files:
            if not file.read_text().startswith('{\n"format"'):
                continue  # A recording's, which holds one.
            calibration = tactus.Calibration.load(file)
            self.assertEqual(len(calibration.baseline),
                             calibration.skin.rows * calibration.skin.columns
                             * calibration.skin.axes)

    @unittest.skipUnless(shutil.which("mypy"), "needs mypy")
    def test_types(self):
        package = pathlib.Path(tactus.__file__).parent
        self.assertTrue((package / "py.typed").exists())
        with tempfile.TemporaryDirectory() as cache:
            done = subprocess.run(
                ["mypy", "--strict", f"--config-file={ROOT}/client/python/pyproject.toml",
                 f"--cache-dir={cache}", f"--python-executable={sys.executable}", "-p", "tactus"],
                capture_output=True, text=True, cwd=cache)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    @unittest.skipUnless(shutil.which("mypy"), "needs mypy")
    def test_types_as_a_program_sees_them(self):
        program = """
from typing import Optional
import numpy as np
import tactus

def feel(client: tactus.Client, skin: tactus.Skin) -> Optional[float]:
    with client.stream(skin, model="arm") as stream:
        for answer in stream.push(np.zeros((2, 2), np.uint16)):
            if answer.main is not None:
                return answer.main.classes["HU"]
    return None

async def feel_too(client: tactus.Client, skin: tactus.Skin) -> str:
    async with client.stream(skin) as stream:
        async for answer in stream.push(np.zeros((2, 2), np.uint16)):
            print(answer.sequence + 1)
        return (await stream.end_trial()).skin.name

def train(client: tactus.Client) -> str:
    return client.train("arm@1", "arm").wait().model_version
"""
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "program.py")
            wrong = pathlib.Path(folder, "wrong.py")
            path.write_text(program)
            wrong.write_text(program.replace("answer.main.classes", "answer.main.nothing"))
            for file, code in ((path, 0), (wrong, 1)):
                done = subprocess.run(
                    ["mypy", "--strict", f"--cache-dir={folder}/cache",
                     f"--python-executable={sys.executable}", file],
                    capture_output=True, text=True, cwd=folder)
                self.assertEqual(done.returncode, code, done.stdout + done.stderr)


if __name__ == "__main__":
    unittest.main()
