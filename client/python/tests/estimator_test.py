"""TouchClassifier in this process: the models of trainctl and of a server."""

import contextlib
import importlib.util
import io
import os
import pathlib
import pickle
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest
from inspect import signature

import numpy

import tactus
from support import Server, run

try:
    from tactus import _native
    from tactus._training import train
except ImportError:
    _native = None

PALM = tactus.Skin(name="palm", rows=6, columns=8, row_pitch_m=0.005, column_pitch_m=0.005,
                   taxel_area_m2=25e-6, unit="counts", contact_threshold=5, onset_threshold=10)


def presses(count, seed, dtype="uint16", axes=1, shape=(6, 8)):
    """Presses of three stiffnesses on a grid: X, y and the day of each."""
    random = numpy.random.default_rng(seed)
    rows, columns = numpy.mgrid[0:shape[0], 0:shape[1]]
    X, y, days = [], [], []
    for i in range(count):
        label = ("hard", "medium", "soft")[i % 3]
        stiffness = {"hard": 50, "medium": 15, "soft": 4}[label] * random.uniform(0.85, 1.15)
        frames = int(random.integers(40, 70))
        row, column = random.uniform(1, shape[0] - 2), random.uniform(1, shape[1] - 2)
        place = numpy.exp(-((rows - row) ** 2 + (columns - column) ** 2) / 1.5)
        depth = numpy.maximum(0, numpy.arange(frames) - 8)
        load = stiffness * depth[:, None, None] * place + random.uniform(
            0, 2, (frames, *shape))
        if axes == 3:
            load = numpy.stack([0.2 * load, -0.1 * load, load], axis=3)
        X.append(load.astype(dtype))
        y.append(label)
        days.append(f"day-{i // 3 % 4}")
    return X, numpy.array(y), days


class WithoutTheModuleTest(unittest.TestCase):
    @unittest.skipIf(_native, "the module is there")
    def test_the_error_says_what_to_do(self):
        X, y, _ = presses(6, 1)
        with self.assertRaises(tactus.Error) as caught:
            tactus.TouchClassifier(PALM).fit(X, y)
        self.assertIn("--pure", caught.exception.advice)
        self.assertIn("address", caught.exception.advice)


class SkinTest(unittest.TestCase):
    """What is read of recordings without a skin."""

    def test_the_grid_of_the_recordings(self):
        from tactus._inferred import inferred_skin

        for dtype, axes, signed in (("uint16", 1, False), ("float32", 1, False),
                                    ("int16", 1, True),
                                    ("int16", 3, True), ("float32", 3, True)):
            with self.subTest(dtype=dtype, axes=axes):
                X, _, _ = presses(9, 2, dtype, axes)
                skin = inferred_skin(X)
                self.assertEqual(skin.shape, X[0].shape[1:])
                self.assertEqual((skin.dtype, skin.scale, skin.signed_values, skin.row_pitch_m),
                                 (dtype, 1.0, signed, 0.005))
                peak = numpy.median([frames.astype(float).max() for frames in X])
                # The noise is below 2, and the loads are hundreds.
                self.assertLess(0.02 * peak, skin.contact_threshold)
                self.assertLess(skin.contact_threshold, 0.1 * peak)
                self.assertLess(skin.contact_threshold, skin.onset_threshold)

    def test_thresholds_are_those_of_an_import(self):
        """The rule of core/import/idle_noise.h, written once more."""
        from tactus._inferred import inferred_skin

        X, _, _ = presses(9, 3)
        idle, peaks = [], []
        for frames in X:
            flat = frames.reshape(len(frames), -1).astype(float)
            quiet = sorted(range(48), key=lambda taxel: flat[:, taxel].mean())[:12]
            idle += [value for taxel in quiet for value in flat[:, taxel]]
            peaks.append(flat.max())
        high = numpy.percentile(idle, 99.9)
        margin = max((high - numpy.median(idle)) / 2, 0.02 * numpy.median(peaks))
        skin = inferred_skin(X)
        self.assertAlmostEqual(skin.contact_threshold, high + margin, 3)
        self.assertAlmostEqual(skin.onset_threshold, high + 2 * margin, 3)

    def test_a_skin_that_is_touched_everywhere(self):
        from tactus._inferred import inferred_skin

        skin = inferred_skin([numpy.full((20, 2, 2), 100, "uint16")] * 2)
        self.assertEqual((skin.contact_threshold, skin.onset_threshold), (2.0, 4.0))

    def test_what_is_no_skin(self):
        from tactus._inferred import inferred_skin

        good = numpy.ones((5, 4, 4), "float32")
        for X, word in (([], "number of recordings"),
                        ([good, good[:, :3]], "(3, 4)"),
                        ([good, good.astype("uint16")], "uint16"),
                        ([good.astype(float)], "float64"),
                        ([good[0]], "(frames, rows, columns)"),
                        ([numpy.ones((5, 4, 4, 2), "float32")], "(frames, rows, columns, 3)"),
                        ([0 * good], "nothing above 0")):
            with self.subTest(word), self.assertRaises(tactus.Error) as caught:
                inferred_skin(X)
            self.assertEqual(caught.exception.reason, "INVALID_TRAINING_DATA")
            self.assertIn(word, str(caught.exception))


@unittest.skipUnless(_native, "needs the compiled module")
class EstimatorTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.X, cls.y, cls.days = presses(36, 4)
        cls.model = tactus.TouchClassifier(PALM, preset="ridge").fit(cls.X, cls.y)

    def test_fit_and_predict(self):
        model = self.model
        self.assertEqual(model.classes_.tolist(), ["hard", "medium", "soft"])
        X, y, _ = presses(30, 5)
        probabilities = model.predict_proba(X)
        self.assertEqual(probabilities.shape, (30, 3))
        numpy.testing.assert_allclose(probabilities.sum(axis=1), 1)
        self.assertGreater(model.score(X, y), 0.8)
        self.assertEqual(model.predict(X).tolist(),
                         model.classes_[probabilities.argmax(axis=1)].tolist())
        untouched = [numpy.zeros((20, 6, 8), "uint16"), numpy.zeros((0, 6, 8), "uint16")]
        numpy.testing.assert_array_equal(model.predict_proba(untouched), numpy.full((2, 3), 1 / 3))
        self.assertEqual(model.predict_proba([]).shape, (0, 3))
        with self.assertRaises(tactus.FrameError):
            model.predict([X[0].astype("float32")])

    def test_so_far_is_causal(self):
        X, _, _ = presses(6, 6)
        tables = self.model.predict_proba_so_far(X)
        self.assertEqual([table.shape for table in tables], [(len(frames), 3) for frames in X])
        numpy.testing.assert_array_equal(numpy.stack([table[-1] for table in tables]),
                                         self.model.predict_proba(X))
        for frames, table in zip(X, tables):
            # Nothing touches the skin in the first eight frames.
            numpy.testing.assert_array_equal(table[:8], numpy.full((8, 3), 1 / 3))
            numpy.testing.assert_allclose(table.sum(axis=1), 1)
            changed = frames.copy()
            changed[25:] = frames[25:][::-1] // 2
            (other,) = self.model.predict_proba_so_far([changed])
            numpy.testing.assert_array_equal(other[:25], table[:25])
            self.assertTrue((other[25:] != table[25:]).any())
            # The end of the frames so far is the end of a shorter recording.
            numpy.testing.assert_array_equal(self.model.predict_proba([frames[:25]])[0],
                                             table[24])
        self.assertEqual(len(self.model.predict_proba_so_far(
            [numpy.zeros((0, 6, 8), "uint16"), X[0]])[0]), 0)

    def test_a_pause_does_not_end_a_recording(self):
        quiet = numpy.zeros((80, 6, 8), "uint16")
        longer = [numpy.concatenate([frames, quiet]) for frames in self.X[:6]]
        self.assertEqual(self.model.predict(longer).tolist(), self.model.predict(self.X[:6]).tolist())

    def test_types_and_axes_without_a_skin(self):
        for dtype, axes in (("uint16", 1), ("int16", 1), ("float32", 1), ("float32", 3),
                            ("int16", 3)):
            with self.subTest(dtype=dtype, axes=axes):
                X, y, _ = presses(24, 7, dtype, axes)
                model = tactus.TouchClassifier(preset="ridge").fit(X, y)
                self.assertGreater(model.score(X, y), 0.9)
                self.assertEqual(model.skin_.shape, X[0].shape[1:])
        grid = numpy.stack([frames[:40] for frames in self.X])
        self.assertEqual(grid.ndim, 4)
        self.assertEqual(len(tactus.TouchClassifier(PALM, preset="nearest").fit(
            grid, self.y).predict(grid)), 36)

    def test_save_and_load(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "a.tactus"
            X, _, _ = presses(12, 8)
            for y, labels in ((self.y, ["hard", "medium", "soft"]),
                              (numpy.searchsorted(["hard", "medium", "soft"], self.y) * 5 + 5,
                               [5, 10, 15]),
                              (self.y == "soft", [False, True])):
                model = tactus.TouchClassifier(PALM, preset="ridge").fit(self.X, y)
                model.save(path)
                again = tactus.TouchClassifier.load(path)
                self.assertEqual(again.classes_.tolist(), labels)
                self.assertEqual(again.classes_.dtype.kind, model.classes_.dtype.kind)
                self.assertEqual(again.skin_.resolved(), tactus.Skin(
                    **{**vars(PALM), "dtype": "uint16"}))
                numpy.testing.assert_array_equal(again.predict_proba(X), model.predict_proba(X))
                numpy.testing.assert_array_equal(
                    again.predict_proba([numpy.zeros((9, 6, 8), "uint16")]),
                    model.predict_proba([numpy.zeros((9, 6, 8), "uint16")]))
                again.save(path)
                self.assertEqual(path.read_bytes(), model._bundle)
            self.assertEqual(tactus.Classifier(path).classes, ("False", "True"))
            for wrong, reason in (("/no/such/file", "IO"), (__file__, "BUNDLE_CORRUPT")):
                with self.assertRaises(tactus.Error) as caught:
                    tactus.TouchClassifier.load(wrong)
                self.assertEqual(caught.exception.reason, reason)

    def test_pickling(self):
        unfitted = tactus.TouchClassifier(PALM, "ridge", threads=1)
        self.assertEqual(pickle.loads(pickle.dumps(unfitted)).get_params(), unfitted.get_params())
        with self.assertRaises(tactus.Error) as caught:
            pickle.dumps(self.model)
        self.assertIn("save", caught.exception.advice)

    def test_errors(self):
        X, y = self.X, self.y
        with self.assertRaises(tactus.Error) as caught:
            tactus.TouchClassifier(PALM).predict(X)
        self.assertEqual(caught.exception.reason, "INVALID_MODEL")
        for call, reason, word in (
                (lambda: tactus.TouchClassifier(PALM, "magic").fit(X, y), "INVALID_CONFIG",
                 "magic"),
                (lambda: tactus.TouchClassifier(PALM, "ridge", threads=0).fit(X, y),
                 "INVALID_CONFIG", "threads"),
                (lambda: tactus.TouchClassifier(PALM, "ridge", seed=-1).fit(X, y),
                 "INVALID_CONFIG", "seed"),
                (lambda: tactus.TouchClassifier(PALM, "ridge").fit(X, y[:-1]), "INVALID_CONFIG",
                 "labels"),
                (lambda: tactus.TouchClassifier(PALM, "ridge").fit(X, y, self.days[1:]),
                 "INVALID_CONFIG", "groups"),
                (lambda: tactus.TouchClassifier(PALM, "ridge").fit(X, ["one"] * 36),
                 "INVALID_TRAINING_DATA", "class"),
                (lambda: tactus.TouchClassifier(PALM, "ridge").fit(
                    [0 * frames for frames in X], y), "INVALID_TRAINING_DATA", "feels nothing"),
                (lambda: tactus.TouchClassifier(PALM.replace(onset_threshold=-1), "ridge").fit(
                    X, y), "INVALID_TRIAL", "onset_threshold"),
                (lambda: tactus.TouchClassifier(PALM, "ridge").fit(
                    [*X[:35], X[35].astype("float32")], y), "INVALID_TRIAL",
                 "trial 000035: taxels.dtype"),
                (lambda: self.model.delete(), "", "in this process")):
            with self.subTest(word), self.assertRaises(tactus.Error) as caught:
                call()
            self.assertEqual(caught.exception.reason, reason)
            self.assertIn(word, str(caught.exception))
        with self.assertRaises(tactus.Error):
            tactus.TouchClassifier().set_params(magic=1)

    def test_progress_and_other_threads(self):
        """Other threads of Python run while a model is fitted."""
        ticks, ended = [], threading.Event()

        def tick():
            while not ended.is_set():
                ticks.append(time.monotonic())
                time.sleep(0.002)

        thread = threading.Thread(target=tick)
        thread.start()
        printed = io.StringIO()
        try:
            with contextlib.redirect_stderr(printed):
                begin = time.monotonic()
                tactus.TouchClassifier(PALM, preset="tuned", threads=1, verbose=True).fit(
                    self.X, self.y)
                end = time.monotonic()
        finally:
            ended.set()
            thread.join()
        self.assertGreater(sum(begin < at < end for at in ticks), 5)
        self.assertIn("train models", printed.getvalue())

    def test_progress_that_raises_ends_the_training(self):
        class Stop(Exception):
            pass

        def stop(phase, fraction):
            raise Stop(phase)

        trials = [tactus.Trial(taxels=frames, label=label, skin=PALM)
                  for frames, label in zip(self.X, self.y)]
        from tactus import _training

        class Bar:
            def __init__(self, work):
                self.show = stop

            def close(self):
                self.closed = True

        before = _training.Bar
        _training.Bar = Bar
        try:
            with self.assertRaises(Stop):
                train(trials, preset="tuned", verbose=True)
        finally:
            _training.Bar = before

    def test_a_signal_ends_the_training(self):
        """Ctrl-C in the middle of a training that would take minutes: while a
        preset is chosen, and while LSTMs are trained."""
        for preset in ("auto", "world"):
            with self.subTest(preset):
                program = (
                    "import sys, numpy, tactus\n"
                    "from tactus import _training\n"
                    "import estimator_test as test\n"
                    "X, y, days = test.presses(240, 9)\n"
                    "class Bar:\n"
                    "    def __init__(self, work): pass\n"
                    "    def show(self, phase, fraction): print(phase, flush=True)\n"
                    "    def close(self): pass\n"
                    "_training.Bar = Bar\n"
                    "try:\n"
                    f"    tactus.TouchClassifier(test.PALM, {preset!r}, verbose=True).fit(X, y)\n"
                    "except KeyboardInterrupt:\n"
                    "    print('interrupted')\n"
                    "    small = tactus.TouchClassifier(test.PALM, 'nearest')\n"
                    "    small.fit(X[:12], y[:12])\n"
                    "    print(small.score(X[:12], y[:12]))\n")
                child = subprocess.Popen([sys.executable, "-B", "-c", program],
                                         stdout=subprocess.PIPE, text=True, env=os.environ)
                wanted = "choose preset" if preset == "auto" else "train models"
                for line in child.stdout:
                    if wanted in line:
                        break
                child.send_signal(signal.SIGINT)
                begin = time.monotonic()
                last = ""
                for line in child.stdout:
                    if line == "interrupted\n":
                        sys.stderr.write(f"\n{preset}: interrupted after "
                                         f"{time.monotonic() - begin:.2f} s\n")
                    last = line
                self.assertEqual(child.wait(), 0)
                child.stdout.close()
                self.assertEqual(last, "1.0\n")


@unittest.skipUnless(_native, "needs the compiled module")
@unittest.skipUnless(importlib.util.find_spec("h5py"), "needs h5py")
class SameModelTest(unittest.TestCase):
    """The bundle is that of trainctl and of a server, bit for bit."""

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        cls.path = pathlib.Path(cls.folder.name)

    def trials(self, X, y, groups):
        return [tactus.Trial(taxels=frames, label=label, skin=PALM, material=group)
                for frames, label, group in zip(X, y, groups)]

    def test_trainctl_fits_the_same_bytes(self):
        X, y, days = presses(48, 10)
        for preset, seed, groups in (("ridge", 1, days), ("tuned", 3, [""] * 48),
                                     ("auto", 2, days), ("", 1, [""] * 48)):
            with self.subTest(preset=preset, seed=seed):
                data, out = self.path / "t.h5", self.path / "t.tactus"
                data.unlink(missing_ok=True)
                trials = self.trials(X, y, groups)
                tactus.write_trials(data, trials)
                arguments = ["fit", f"--data={data}", f"--out={out}", f"--seed={seed}",
                             "--note=same"]
                if preset:
                    arguments.append(f"--preset={preset}")
                run("trainctl", *arguments)
                bundle = train(trials, preset=preset, seed=seed, note="same", data=str(data),
                               command=" ".join(["trainctl", *arguments]))
                self.assertEqual(bundle, out.read_bytes())

    def test_a_server_trains_the_same_model(self):
        X, y, days = presses(48, 11)
        probe = presses(64, 12)[0]
        with Server("--data-dir=FOLDER/data") as server:
            for preset in ("ridge", "tuned"):
                with self.subTest(preset):
                    here = tactus.TouchClassifier(PALM, preset).fit(X, y, groups=days)
                    there = tactus.TouchClassifier(PALM, preset, address=server.address)
                    there.fit(X, y, groups=days)
                    numpy.testing.assert_array_equal(here.predict_proba(probe),
                                                     there.predict_proba(probe))
                    for ours, theirs in zip(here.predict_proba_so_far(probe[:6]),
                                            there.predict_proba_so_far(probe[:6])):
                        numpy.testing.assert_array_equal(ours, theirs)
                    there.save(self.path / "there.tactus")
                    again = tactus.TouchClassifier.load(self.path / "there.tactus")
                    numpy.testing.assert_array_equal(again.predict_proba(probe),
                                                     here.predict_proba(probe))

    def test_threads_do_not_change_the_model(self):
        X, y, days = presses(36, 13)
        trials = self.trials(X, y, days)
        self.assertEqual(train(trials, preset="tuned", threads=1),
                         train(trials, preset="tuned", threads=3))

    def test_a_bundle_of_trainctl(self):
        """Its classes have the order of the bundle, and the estimator's its own."""
        data, out = self.path / "s.h5", self.path / "s.tactus"
        run("trainctl", "simulate", "--protocol=random", "--contacts=40", "--skin=good",
            "--seed=5", f"--out={data}")
        run("trainctl", "fit", f"--data={data}", f"--out={out}", "--preset=ridge")
        model = tactus.TouchClassifier.load(out)
        self.assertEqual(model.classes_.tolist(), sorted(model.classes_.tolist()))
        self.assertEqual(set(model.classes_), set(tactus.Classifier(out).classes))
        recording = tactus.Recording(data)
        self.assertEqual(model.skin_.dtype, "float32")
        X = [trial.loads for trial in recording]
        self.assertGreater(model.score(X, [trial.label for trial in recording]), 0.6)


@unittest.skipUnless(_native, "needs the compiled module")
@unittest.skipUnless(importlib.util.find_spec("sklearn"), "needs scikit-learn")
class ScikitLearnTest(unittest.TestCase):
    def test_its_tools(self):
        from sklearn.base import clone, is_classifier
        from sklearn.model_selection import (GridSearchCV, GroupKFold, cross_val_predict,
                                             cross_val_score)
        from sklearn.pipeline import Pipeline
        from sklearn.preprocessing import FunctionTransformer
        from sklearn.utils.validation import check_is_fitted

        X, y, days = presses(36, 14)
        model = tactus.TouchClassifier(PALM, preset="ridge")
        self.assertTrue(is_classifier(model))
        copy = clone(model)
        self.assertEqual(copy.get_params(), model.get_params())
        self.assertIs(model.fit(X, y, groups=days), model)
        check_is_fitted(model)
        with self.assertRaises(Exception):
            check_is_fitted(copy)
        self.assertFalse("_bundle" in vars(clone(model)))
        self.assertGreater(cross_val_score(copy, X, y, cv=3).mean(), 0.7)
        self.assertGreater(cross_val_score(copy, X, y, cv=GroupKFold(4), groups=days).mean(), 0.7)
        self.assertEqual(cross_val_predict(copy, X, y, cv=3, method="predict_proba").shape,
                         (36, 3))
        search = GridSearchCV(tactus.TouchClassifier(PALM), {"preset": ["ridge", "nearest"]},
                              cv=2).fit(X, y)
        self.assertIn(search.best_params_["preset"], ("ridge", "nearest"))
        self.assertEqual(len(search.predict(X)), 36)
        halves = Pipeline([
            ("every second frame", FunctionTransformer(lambda X: [frames[::2] for frames in X])),
            ("classify", tactus.TouchClassifier(PALM.replace(rate_hz=50)))])
        halves.set_params(classify__preset="ridge")
        self.assertGreater(halves.fit(X, y, classify__groups=days).score(X, y), 0.9)

    def test_groups_of_a_cross_validation(self):
        """Each fit has the groups of its own recordings, in their order."""
        from sklearn.model_selection import GroupKFold, cross_val_predict, cross_val_score

        seen = []

        class Noting(tactus.TouchClassifier):
            def fit(self, X, y, groups=None):
                seen.append(groups)
                return super().fit(X, y, groups=groups)

        X, y, days = presses(36, 16)
        folds = GroupKFold(4)
        wanted = [[days[i] for i in train] for train, _ in folds.split(X, y, days)]
        model = Noting(PALM, preset="ridge", threads=1)
        name = "fit_params" if "fit_params" in signature(cross_val_score).parameters else "params"
        for passed in (days, numpy.array(days)):
            for evaluate in (cross_val_score, cross_val_predict):
                seen.clear()
                evaluate(model, X, y, cv=folds, groups=days, **{name: {"groups": passed}})
                self.assertEqual([list(groups) for groups in seen], wanted)
        seen.clear()
        cross_val_score(model, X, y, cv=folds, groups=days)
        self.assertEqual(seen, [None] * 4)

    def test_processes(self):
        """joblib sends an estimator that is not fitted to other processes."""
        from sklearn.model_selection import cross_val_score

        X, y, _ = presses(24, 15)
        model = tactus.TouchClassifier(PALM, preset="ridge", threads=1)
        self.assertEqual(cross_val_score(model, X, y, cv=2, n_jobs=2).tolist(),
                         cross_val_score(model, X, y, cv=2).tolist())


if __name__ == "__main__":
    unittest.main()
