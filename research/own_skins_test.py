#!/usr/bin/python3
"""Tests of research/own_skins.py with a program in the place of trainctl."""

import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

import numpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import own_skins  # noqa: E402

STUB = '''#!/usr/bin/python3
import json, pathlib, sys
flags = dict(word.lstrip("-").partition("=")[::2] for word in sys.argv[2:])
with open("calls.txt", "a") as calls:
    calls.write(" ".join(sys.argv[1:]) + "\\n")
preset, seed = flags.get("preset", ""), int(flags["seed"])
if preset == "nearest":
    sys.exit("trainctl: unknown preset nearest [INVALID_CONFIG]")
if pathlib.Path("broken").exists() and "slip" in flags["data"]:
    sys.exit("trainctl: broken")
right = 100 + seed - (10 if preset else 0)
none_sure = preset == "profile"
print(json.dumps({
    "accuracy": right / 200, "accuracy_interval": [right / 200 - 0.05, right / 200 + 0.05],
    "ece": 0.01 * seed, "trials": 201, "felt": 200, "right": right,
    "preset": preset or ("ridge" if seed < 3 else "pattern"), "seed": seed,
    "accuracy_at": {"0.1": 0.1, "0.25": 0.25, "0.5": 0.3, "1.2": 0.4,
                    "2.5": 0.515 if seed == 2 else 0.4, "5": 0.5},
    "selective": {"answered": 0 if none_sure else 50, "right": 0 if none_sure else 49,
                  "coverage": 0.25, "accuracy": None if none_sure else 0.98,
                  "auroc": None if none_sure or seed == 3 else 0.7 + 0.1 * seed},
    "confusion": [[70, 50], [40, 40]],
    "choice": None if preset else
        {"nearest_accuracy": 0.5, "chance": 0.25, "contacts": 200, "folds": 5},
    "candidates": [] if preset else [
        {"name": "ridge (ridge)", "accuracy": 0.6, "standard_error": 0.0346, "chosen": True},
        {"name": "pattern (HMMs)", "accuracy": 0.5, "standard_error": 0.0354, "chosen": False}],
}))
'''


class OwnSkinsTest(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)
        self.trainctl = self.folder / "trainctl"
        self.trainctl.write_text(STUB)
        self.trainctl.chmod(0o755)
        dice = numpy.random.default_rng(1)
        for each in own_skins.SETS:
            folder = self.folder / each.name
            folder.mkdir()
            (self.folder / f"{each.name}.h5").write_text(each.name)
            (folder / "skin.json").write_text('{"name": "test", "contact_threshold": 1}')
            lines = ["frames,label,condition,group"]
            for i in range(8):
                numpy.save(folder / f"{i}.npy", dice.uniform(1, 9, (12, 4)))
                lines.append(f"{i}.npy,{'ab'[i % 2]},c{i // 4},g{i // 4}")
            (folder / "trials.csv").write_text("\n".join(lines) + "\n")
        self.splits = sum(len(each.splits) for each in own_skins.SETS)

    def run_program(self, *flags):
        program = os.path.join(os.path.dirname(os.path.abspath(__file__)), "own_skins.py")
        return subprocess.run(
            [sys.executable, "-B", program, self.trainctl, self.folder, *flags],
            capture_output=True,
            text=True,
            check=False,
        )

    def calls(self):
        path = self.folder / "calls.txt"
        calls = path.read_text().splitlines() if path.exists() else []
        path.unlink(missing_ok=True)
        return calls

    def test_page(self):
        run = self.run_program("--seeds=3")
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertEqual(len(self.calls()), self.splits * (3 + len(own_skins.PRESETS)))
        page = run.stdout
        for each in own_skins.SETS:
            self.assertIn(f"\n## {each.title}\n", page)
            self.assertIn(f"| licence | {each.licence} |", page)
        self.assertIn(
            "| default, seed 1: `ridge` | 50.50 (45.50 to 55.50) | 0.010 | 50, 49 right "
            "| 0.80 | 25.00 | 30.00 | 40.00 |",
            page,
        )
        self.assertIn(
            "| default, seeds 1 to 3: mean (smallest to largest) | 51.00 (50.50 to 51.50) "
            "| 0.020 (0.010 to 0.030) | 50 (50 to 50), 49 (49 to 49) right "
            "| 0.85 (0.80 to 0.90) |",
            page,
        )
        self.assertIn(
            "The largest fall from an earlier moment to the end: 0.00 points (seed 1), "
            "0.50 (largest of the seeds).",
            page,
        )
        self.assertIn("The default chose `ridge` in 2, `pattern` in 1 of the runs.", page)
        self.assertIn("| `nearest` | refused: unknown preset nearest [INVALID_CONFIG] |", page)
        self.assertIn("| `profile` | 45.50 (40.50 to 50.50) | 0.010 | 0, 0 right | - |", page)
        self.assertIn("| constant answer | 60.00 (53.08 to 66.54) |", page)
        self.assertIn("| ridge (ridge) | 60.00 | 3.46 | chosen |", page)
        self.assertIn("| pattern (HMMs) | 50.00 | 3.54 |  |", page)
        # Every row of a table has the cells of the one above it.
        lines = page.splitlines()
        for above, line in zip(lines, lines[1:]):
            if above.startswith("|") and line.startswith("|"):
                self.assertEqual(above.count("|"), line.count("|"), line)
        # The commands are those that ran.
        self.assertIn(
            "\n$ trainctl evaluate --data=icub_slide20.h5 --protocol=k-fold --folds=5 "
            "--preset=ridge --seed=1 --json\n",
            page,
        )
        self.assertNotIn(str(self.folder), page)

    def test_results_are_kept(self):
        first = self.run_program("--seeds=2")
        self.calls()
        again = self.run_program("--seeds=2")
        self.assertEqual(again.stdout, first.stdout)
        # What was refused is tried again.
        calls = self.calls()
        self.assertEqual(len(calls), self.splits)
        self.assertTrue(all("--preset=nearest" in call for call in calls))
        # Other trials are evaluated anew, and so is what another program has evaluated.
        (self.folder / "slip.h5").write_text("other trials")
        self.run_program("--seeds=2")
        self.assertEqual(sum("slip" in call for call in self.calls()), 2 + len(own_skins.PRESETS))
        self.trainctl.write_text(STUB + "# another one\n")
        self.run_program("--seeds=2")
        self.assertEqual(len(self.calls()), self.splits * (2 + len(own_skins.PRESETS)))

    def test_goes_on_after_an_interruption(self):
        (self.folder / "broken").touch()
        run = self.run_program("--seeds=1")
        self.assertNotEqual(run.returncode, 0)
        self.assertEqual(run.stdout, "")
        self.assertIn("slip-leave-one-material-out-default-1", run.stderr)
        before = self.calls()
        (self.folder / "broken").unlink()
        self.assertEqual(self.run_program("--seeds=1").returncode, 0)
        done = [call for call in before if "fabric" in call and "nearest" not in call]
        self.assertEqual(len(done), len(own_skins.PRESETS))
        self.assertFalse(set(done) & set(self.calls()))

    def test_a_missing_set_is_named(self):
        (self.folder / "pads.h5").unlink()
        run = self.run_program()
        self.assertIn("lacks pads.h5", run.stderr)
        self.assertNotEqual(run.returncode, 0)

    def test_results_are_json(self):
        self.run_program("--seeds=1")
        file = self.folder / "results" / "fabric-loco-default-1.json"
        kept = json.loads(file.read_text())
        self.assertEqual(kept["result"]["right"], 101)
        # The table has the time of the run that is kept.
        self.assertGreater(kept["cpu_seconds"], 0)
        file.write_text(json.dumps(kept | {"cpu_seconds": 123.4}))
        self.assertIn(
            "| default, seed 1: `ridge` | 50.50 (45.50 to 55.50) | 0.010 | 50, 49 right "
            "| 0.80 | 25.00 | 30.00 | 40.00 | 123 |",
            self.run_program("--seeds=1").stdout,
        )


if __name__ == "__main__":
    unittest.main()
