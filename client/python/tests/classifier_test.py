"""Classification in this process: the answers of a server, bit for bit."""

import pathlib
import threading
import unittest

import numpy

import tactus
from support import FOREARM, ROOT, Server, run, touch

try:
    from tactus import _native
except ImportError:
    _native = None

NO_POSES = ROOT / "server/registry/no-poses.tactus"
DEFAULT = ROOT / "server/registry/default.tactus"


class WithoutTheModuleTest(unittest.TestCase):
    @unittest.skipIf(_native, "the module is there")
    def test_the_error_says_what_to_do(self):
        with self.assertRaises(tactus.Error) as caught:
            tactus.Classifier(NO_POSES)
        self.assertIn("--pure", caught.exception.advice)


@unittest.skipUnless(_native, "needs the compiled module")
class ClassifierTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.server = Server()
        cls.addClassCleanup(cls.server.stop)

    def test_answers_are_those_of_a_server(self):
        classifier = tactus.Classifier(NO_POSES)
        for options in ({}, {"frames_per_message": 16}, {"interval_frames": 7},
                        {"low_effort": True}, {"with_taxels": True}, {"max_contacts": 1}):
            with self.subTest(**options):
                with classifier.stream(FOREARM, **options) as stream:
                    ours = [a for frame in touch(120) for a in stream.push(frame)]
                    ours.append(stream.end_trial())
                    self.assertEqual(stream.info.model_version, str(NO_POSES))
                with tactus.Client(self.server.address) as client, \
                        client.stream(FOREARM, **options) as stream:
                    theirs = [a for frame in touch(120) for a in stream.push(frame)]
                    theirs.append(stream.end_trial())
                    self.assertEqual(stream.info.model_sha256, classifier.sha256)
                self.assertEqual(repr(ours), repr(theirs))

    def test_sixty_four_contacts_with_poses(self):
        path = self.server.path / "contacts.h5"
        run("trainctl", "simulate", "--protocol=random", "--contacts=64", "--skin=good",
            "--seed=12", f"--out={path}")
        recording = tactus.Recording(path)
        ours = tactus.Classifier(DEFAULT).classify(recording)
        with tactus.Client(self.server.address) as client:
            for trial, answer in zip(recording, ours):
                with client.stream(trial.skin, model="default", cadence="events",
                                   frames_per_message=32) as stream:
                    stream.push_many(trial.taxels, poses=trial.poses)
                    self.assertEqual(repr(stream.end_trial()), repr(answer))

    def test_errors_are_those_of_a_server(self):
        classifier = tactus.Classifier(NO_POSES)
        stream = classifier.stream(FOREARM.replace(dtype="float32", scale=1.0))
        stream.push(numpy.zeros((16, 24), "float32"))
        with self.assertRaises(tactus.Error) as caught:
            stream.push(numpy.full((16, 24), numpy.nan, "float32"))
        self.assertEqual(caught.exception.reason, "NON_FINITE_TAXEL")
        self.assertTrue(stream.ended)
        for call, reason in (
                (lambda: tactus.Classifier("/no/such/file"), "IO"),
                (lambda: tactus.Classifier(__file__), "BUNDLE_CORRUPT"),
                (lambda: classifier.stream(FOREARM, model="x"), "INVALID_CONFIG"),
                (lambda: classifier.stream(tactus.Skin(name="vitac-12x32")),
                 "GEOMETRY_MISMATCH")):
            with self.assertRaises(tactus.Error) as caught:
                call()
            self.assertEqual(caught.exception.reason, reason)
        damaged = self.server.path / "damaged.tactus"
        damaged.write_bytes(NO_POSES.read_bytes()[:-100] + bytes(100))
        with self.assertRaises(tactus.Error) as caught:
            tactus.Classifier(pathlib.Path(damaged))
        self.assertEqual(caught.exception.reason, "BUNDLE_CORRUPT")

    def test_threads_share_a_model(self):
        classifier = tactus.Classifier(NO_POSES)
        finals = {}

        def work(i):
            with classifier.open(FOREARM) as stream:
                for frame in touch(100):
                    stream.push(frame)
                finals[i] = repr(stream.end_trial())

        threads = [threading.Thread(target=work, args=(i,)) for i in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(len(finals), 4)
        self.assertEqual(len(set(finals.values())), 1)


if __name__ == "__main__":
    unittest.main()
