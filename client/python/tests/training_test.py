"""The training service: from arrays to a served model, and labels back."""

import contextlib
import importlib.util
import io
import pathlib
import threading
import time
import unittest
import xml.etree.ElementTree

import numpy

import tactus
from support import Server, run
from tactus._crc32c import crc32c
from tactus._jobs import evaluation_of
from tactus.v1 import operations_pb2


class TrainingTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.server = Server("--data-dir=FOLDER/data", "--keep-contacts=16M")
        cls.addClassCleanup(cls.server.stop)
        path = cls.server.path / "trials.h5"
        run("trainctl", "simulate", "--protocol=random", "--contacts=40", "--skin=good",
            "--seed=5", f"--out={path}")
        cls.path = path
        cls.recording = tactus.Recording(path)

    def setUp(self):
        self.client = tactus.Client(self.server.address)
        self.addCleanup(self.client.close)

    def trial(self, id, label="HU", seed=0, frames=50):
        taxels = numpy.random.default_rng(seed).integers(0, 500, (frames, 16, 24)).astype("u2")
        return tactus.Trial(taxels=taxels, label=label, id=id,
                            skin=tactus.Skin(name="cody-forearm", scale=0.001))

    def test_from_arrays_to_a_served_model(self):
        client = self.client
        dataset = client.create_dataset("arm", "forty contacts")
        confirmed = []
        upload = dataset.upload(self.recording[:32], progress=confirmed.append)
        self.assertEqual(upload.version.name, "datasets/arm/versions/1")
        self.assertEqual(upload.version.trials, 32)
        self.assertEqual(sum(upload.version.labels.values()), 32)
        self.assertTrue(confirmed)
        held_out = client.create_dataset("held-out")
        held_out.upload(self.recording[32:])

        job = client.train("arm@1", "touch", preset="ridge", note="a test")
        points = list(job.points())
        result = job.wait(120)
        self.assertEqual(job.state, "succeeded")
        self.assertEqual(result.model_version, "models/touch/versions/1")
        self.assertTrue(all(point.part for point in points))
        self.assertEqual(client.model("touch").dataset_version, "datasets/arm/versions/1")
        self.assertIn(job.name, [j.name for j in client.jobs()])

        with contextlib.redirect_stderr(io.StringIO()):
            evaluation = client.evaluate("held-out", "touch@1").wait(60, progress=True).evaluation
        self.assertEqual(evaluation.accuracy.contacts + evaluation.never_felt, 8)
        self.assertEqual(sum(map(sum, evaluation.confusion)), evaluation.accuracy.contacts)
        self.assertFalse(evaluation.trained_on_data)
        self.check_reliability(evaluation)
        self.check_questions(evaluation)
        folds = client.evaluate("arm", protocol="k-fold", preset="nearest").wait(120)
        self.assertEqual(folds.evaluation.accuracy.contacts + folds.evaluation.never_felt, 32)
        self.check_reliability(folds.evaluation)

        with self.assertRaises(tactus.Error) as caught:
            client.alias()
        self.assertEqual(caught.exception.reason, "ALIAS_NOT_FOUND")
        before = "models/default/versions/1"
        client.promote(before).wait(60)
        client.promote("touch@1").wait(60)
        self.assertEqual(client.alias().model_version, "models/touch/versions/1")
        trial = self.recording[33]
        with client.stream(trial.skin, client_id="robot-1") as stream:
            self.assertEqual(stream.info.model_version, "models/touch/versions/1")
            for frame, pose in zip(trial.taxels, trial.poses):
                stream.push(frame, pose=pose)
            final = stream.end_trial()
        self.assertEqual(client.rollback().model_version, before)
        self.assertTrue(client.alias_history()[0].rollback)

        # The contact that was streamed is in the log, and becomes a trial.
        contacts = self.await_contacts(lambda: list(client.contacts(robot="robot-1")))
        contact = contacts[0]
        self.assertEqual(contact.label, final.main.best)
        self.assertEqual(contact.model_version, "models/touch/versions/1")
        self.assertIsNone(contact.given_label)
        replay = client.replay_contact(contact)
        self.assertEqual(replay.loads.shape[1:], (16, 24))
        self.assertEqual(len(replay.answers), len(replay.loads))
        labelled = client.label_contacts(
            "arm", {contact: tactus.ContactLabel("HU", object="table")}, reason="seen")
        self.assertEqual(labelled.name, "datasets/arm/versions/2")
        self.assertEqual(labelled.trials, 33)
        (again,) = client.contacts(robot="robot-1", labelled=True, with_pictures=True)
        self.assertEqual(again.given_label, "HU")
        self.assertEqual(again.picture.shape, (16, 24))

        path = self.server.path / "touch.tactus"
        client.export_model("touch@1", path)
        imported = client.import_model("copy", path)
        self.assertEqual(imported.sha256, client.model("touch@1").sha256)
        client.delete_model("copy@1")
        with self.assertRaises(tactus.Error) as caught:
            client.model("copy@1")
        self.assertEqual(caught.exception.reason, "MODEL_NOT_FOUND")

    def check_reliability(self, evaluation):
        bins = evaluation.reliability
        self.assertTrue(bins)
        counts = numpy.array([b.accuracy.contacts for b in bins])
        self.assertEqual(counts.sum(), evaluation.accuracy.contacts)
        self.assertEqual(sum(b.accuracy.correct for b in bins), evaluation.accuracy.correct)
        self.assertEqual(list(bins), sorted(bins, key=lambda b: b.low))
        for b in bins:
            self.assertLessEqual(b.low, b.confidence)
            self.assertLessEqual(b.confidence, b.high)
        # Its definition (Naeini et al. 2015).
        gaps = numpy.array([abs(b.accuracy.value - b.confidence) for b in bins])
        self.assertAlmostEqual((counts * gaps).sum() / counts.sum(),
                               evaluation.calibration_error, places=9)

    def check_questions(self, evaluation):
        self.assertEqual(set(evaluation.questions), {"hardness", "mobility"})
        for report in evaluation.questions.values():
            self.assertEqual(report.accuracy.contacts, evaluation.accuracy.contacts)
            self.assertEqual(list(report.anytime), list(evaluation.anytime))
        html = xml.etree.ElementTree.fromstring(evaluation._repr_html_())
        tables = {table.find("caption").text: [[cell.text or "" for cell in row]
                                               for row in table.findall("tr")[1:]]
                  for table in html.iter("table")}
        self.assertEqual(tables["Questions"], [[name, str(report.accuracy)] for name, report
                                               in evaluation.questions.items()])
        self.assertEqual([row[2] for row in tables["Reliability"]],
                         [str(b.accuracy) for b in evaluation.reliability])
        self.assertEqual([row[1:] for row in tables["True class by predicted class"]],
                         [[str(count) for count in row] for row in evaluation.confusion])

    def test_evaluations_of_earlier_releases(self):
        report = operations_pb2.EvaluationReport(class_names=["<a>", "b"], confusion=[3, 1, 0, 2])
        evaluation = evaluation_of(report)
        self.assertEqual((dict(evaluation.questions), evaluation.reliability), ({}, ()))
        html = evaluation._repr_html_()
        self.assertEqual(html.count("<table>"), 1)
        self.assertIn("&lt;a&gt;", html)

    def await_contacts(self, get):
        end = time.monotonic() + 30
        while time.monotonic() < end:
            found = get()
            if found:
                return found
            time.sleep(0.05)
        self.fail("no contact was logged")

    def test_gates_and_canaries(self):
        client = self.client
        client.create_dataset("gate").upload(self.recording[:16])
        version = client.import_model("gated", pathlib.Path(__file__).parents[3]
                                      / "server/registry/no-poses.tactus")
        client.promote(version, "lab").wait(60)
        gate = tactus.Gate("gate@1", accuracy_margin=1.0, log_loss_margin=100.0,
                           calibration_margin=1.0)
        alias = client.update_alias("lab", gate=gate, canary=(version, 10))
        self.assertEqual(alias.gate.dataset_version, "datasets/gate/versions/1")
        self.assertEqual((alias.canary_version, alias.canary_per_mille), (version.name, 10))
        with self.assertRaises(tactus.Error) as caught:
            client.update_alias("lab", etag="stale")
        self.assertEqual(caught.exception.reason, "ETAG_MISMATCH")
        self.assertIsNone(client.update_alias("lab").gate)

    def test_datasets(self):
        client = self.client
        dataset = client.create_dataset("edits")
        with self.assertRaises(tactus.Error) as caught:
            client.create_dataset("edits")
        self.assertEqual(caught.exception.reason, "DATASET_EXISTS")
        trials = [self.trial(f"a-{i}", "soft" if i % 2 else "hard", i) for i in range(4)]
        dataset.upload(trials)
        upload = dataset.upload([trials[0], self.trial("a-1", "hard", 9)])
        self.assertEqual([note.kind for note in upload.notes], ["duplicate", "renamed"])
        self.assertEqual(upload.version.trials, 5)
        version = dataset.relabel(["a-0"], label="soft", reason="a typo")
        self.assertEqual((version.relabelled, version.reason), (1, "a typo"))
        self.assertEqual([t.label for t in dataset.trials() if t.id == "a-0"], ["soft"])
        version = dataset.remove(["a-3"], reason="upside down")
        self.assertEqual(version.removed, 1)
        self.assertEqual([v.number for v in dataset.versions], [1, 2, 3, 4])
        self.assertEqual([t.id for t in dataset.trials(1, label="hard")], ["a-0", "a-2"])
        back = dataset.download(1)
        for ours, theirs in zip(trials, back):
            numpy.testing.assert_array_equal(ours.taxels, theirs.taxels)
            self.assertEqual((ours.id, ours.label, theirs.skin.scale),
                             (theirs.id, theirs.label, 0.001))
        self.assertIn("datasets/edits", [d.name for d in client.datasets()])
        # The trial with another label is stored beside the first one.
        self.assertEqual(dataset.delete(), 6)
        with self.assertRaises(tactus.Error) as caught:
            client.dataset("edits")
        self.assertEqual(caught.exception.reason, "DATASET_NOT_FOUND")

    def test_a_wrong_trial_is_named(self):
        with self.assertRaises(tactus.Error) as caught:
            self.client.create_dataset("wrong").upload([self.trial("a b")])
        self.assertEqual(caught.exception.reason, "INVALID_TRIAL")
        self.assertIn("a b", str(caught.exception))
        skin = tactus.Skin(name="cody-forearm")
        for taxels, word in ((numpy.zeros((5, 16, 23), "u2"), "(frames, 16, 24)"),
                             (numpy.zeros((5, 16, 24), "f8"), "uint16")):
            with self.assertRaises(tactus.Error) as caught:
                tactus.Trial(taxels=taxels, skin=skin)
            self.assertIn(word, str(caught.exception))

    def test_a_job_that_fails_and_one_that_is_cancelled(self):
        client = self.client
        client.create_dataset("one-class").upload([self.trial(f"b-{i}", seed=i)
                                                   for i in range(3)])
        with self.assertRaises(tactus.Error) as caught:
            client.train("one-class", "m", preset="ridge").wait(60)
        self.assertTrue(caught.exception.reason)
        client.create_dataset("long").upload(self.recording[:])
        job = client.train("long", "slow", preset="world", epochs=1000)
        with self.assertRaises(TimeoutError):
            job.wait(0.2)
        job.cancel()
        with self.assertRaises(tactus.JobError) as caught:
            job.wait(60)
        self.assertEqual(caught.exception.reason, "CANCELLED")
        self.assertIsInstance(job.log(), str)
        job.delete()
        with self.assertRaises(tactus.Error) as caught:
            client.job(job.name)
        self.assertEqual(caught.exception.reason, "OPERATION_NOT_FOUND")

    def test_an_upload_survives_kills(self):
        with Server("--data-dir=FOLDER/data") as server, tactus.Client(server.address) as client:
            dataset = client.create_dataset("big")
            # 60 MB: two calls, of which the server confirms each at its end.
            trials = [self.trial(f"c-{i}", seed=i, frames=800) for i in range(100)]
            killed = threading.Event()

            def kill(size):
                if not killed.is_set():
                    killed.set()
                    server.kill()
                    threading.Timer(0.3, server.start).start()

            upload = dataset.upload(trials, progress=kill)
            self.assertTrue(killed.is_set())
            self.assertEqual(upload.version.trials, 100)
            # The same request again changes nothing.
            again = dataset.upload(trials[:1], request_id="one")
            self.assertEqual(dataset.upload(trials[:1], request_id="one").version, again.version)

    @unittest.skipUnless(importlib.util.find_spec("sklearn"), "needs scikit-learn")
    def test_scikit_learn(self):
        import pickle

        from sklearn.base import clone
        from sklearn.model_selection import cross_val_score

        random = numpy.random.default_rng(7)
        skin = tactus.Skin(name="cody-forearm", dtype="float32")
        X, y = [], []
        for label, force in (("firm", 2.0), ("light", 0.2)) * 8:
            frames = numpy.zeros((60, 16, 24), "float32")
            row, column = random.integers(2, 12, 2)
            frames[5:55, row:row + 2, column:column + 2] = force * random.uniform(0.9, 1.1)
            X.append(frames[:random.integers(50, 60)])
            y.append(label)
        model = tactus.TouchClassifier(skin, "ridge", address=self.server.address)
        with self.assertRaises(tactus.Error):
            model.predict(X)
        copy = clone(model)
        self.assertEqual(copy.get_params(), model.get_params())
        self.assertIs(model.fit(X, y), model)
        self.assertEqual(model.classes_.tolist(), ["firm", "light"])
        probabilities = model.predict_proba(X)
        self.assertEqual(probabilities.shape, (16, 2))
        numpy.testing.assert_allclose(probabilities.sum(axis=1), 1)
        self.assertEqual(model.score(X, y), 1.0)
        again = pickle.loads(pickle.dumps(model))
        self.assertEqual(again.predict(X).tolist(), y)
        untouched = [numpy.zeros((20, 16, 24), "float32")]
        self.assertEqual(model.predict_proba(untouched).tolist(), [[0.5, 0.5]])
        self.assertGreater(cross_val_score(copy, X, y, cv=2).mean(), 0.8)
        name = model.model_version_.split("/")[1]
        model.delete()
        self.assertNotIn(f"datasets/{name}", [d.name for d in self.client.datasets()])

    def test_crc32c(self):
        table = []
        for byte in range(256):
            for _ in range(8):
                byte = byte >> 1 ^ (0x82F63B78 if byte & 1 else 0)
            table.append(byte)
        data = numpy.random.default_rng(3).bytes(70_000)
        for size in (0, 1, 255, 256, 4352, 5000, 65_537, 70_000):
            crc = 0xFFFFFFFF
            for byte in data[:size]:
                crc = table[(crc ^ byte) & 255] ^ crc >> 8
            self.assertEqual(crc32c(data[:size]), crc ^ 0xFFFFFFFF, size)
        self.assertEqual(crc32c(data[777:], crc32c(data[:777])), crc32c(data))
        # RFC 3720, appendix B.4.
        self.assertEqual(crc32c(bytes(32)), 0x8A9136AA)
        self.assertEqual(crc32c(b"\xff" * 32), 0x62A8AB43)


if __name__ == "__main__":
    unittest.main()
