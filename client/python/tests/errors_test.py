"""Errors: their reasons, their texts, and that a stream goes on where it can."""

import os
import pickle
import unittest

import numpy

import tactus
from support import FOREARM, Server, free_port, run, touch


class FrameErrorTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.server = Server()
        cls.addClassCleanup(cls.server.stop)

    def refused(self, frame, reason, *words, skin=FOREARM, **push):
        """The frame is refused here, and the stream goes on."""
        with tactus.Client(self.server.address) as client, client.stream(skin) as stream:
            with self.assertRaises(tactus.FrameError) as caught:
                stream.push(frame, **push)
            error = caught.exception
            self.assertEqual(error.reason, reason)
            for word in words:
                self.assertIn(word, str(error))
            self.assertEqual(len(stream.push(stream.skin.zeros())), 1)
        self.assertIsInstance(error, ValueError)
        again = pickle.loads(pickle.dumps(error))
        self.assertEqual((str(again), again.reason), (str(error), error.reason))

    def test_wrong_types(self):
        self.refused([[0] * 24] * 16, "INVALID_CONFIG", "a list",
                     "numpy.asarray(frame, numpy.uint16)")
        self.refused(b"\0" * 768, "INVALID_CONFIG", "a bytes")
        for dtype in ("float64", "float32", "int16", "int64", "uint8", "bool", "complex64"):
            self.refused(numpy.zeros((16, 24), dtype), "INVALID_CONFIG", dtype, "uint16",
                         "frame.astype(numpy.uint16)")
        self.refused(numpy.zeros((16, 24), ">u2"), "INVALID_CONFIG", ">u2", "uint16")
        self.refused(numpy.zeros((16, 24), object), "INVALID_CONFIG", "object")

    def test_wrong_shapes(self):
        for shape in ((24, 16), (16, 23), (16, 24, 3), (1, 16, 24), (383,), (), (0,)):
            self.refused(numpy.zeros(shape, "uint16"), "FRAME_SIZE_MISMATCH", str(shape),
                         "(16, 24)")

    def test_wrong_memory(self):
        self.refused(numpy.zeros((16, 48), "uint16")[:, ::2], "INVALID_CONFIG", "not contiguous",
                     "numpy.ascontiguousarray(frame)")
        self.refused(numpy.zeros((24, 16), "uint16").T, "INVALID_CONFIG", "not contiguous")

    def test_other_arguments(self):
        frame = numpy.zeros((16, 24), "uint16")
        self.refused(frame, "INVALID_POSE", "the skin has none", pose=(0,) * 7)
        poses = FOREARM.replace(with_poses=True)
        with tactus.Client(self.server.address) as client, client.stream(poses) as stream:
            for pose in (None, (0, 0, 0)):
                with self.assertRaises(tactus.FrameError) as caught:
                    stream.push(frame, pose=pose)
                self.assertEqual(caught.exception.reason, "INVALID_POSE")
            self.assertEqual(stream.push(frame, pose=(0, 0, 0, 0, 0, 0, 1))[0].sequence, 1)

    def test_a_flat_frame_and_a_read_only_one_are_right(self):
        with tactus.Client(self.server.address) as client, client.stream(FOREARM) as stream:
            self.assertEqual(len(stream.push(numpy.zeros(384, "uint16"))), 1)
            frame = numpy.zeros((16, 24), "uint16")
            frame.setflags(write=False)
            self.assertEqual(len(stream.push(frame)), 1)

    def test_what_the_server_refuses_ends_the_stream(self):
        nan = numpy.zeros((16, 24), "float32")
        nan[3, 4] = numpy.nan
        for frame, reason, word in (
                (nan, "NON_FINITE_TAXEL", "taxel 76"),
                (numpy.full((16, 24), -1, "float32"), "NEGATIVE_TAXEL", "at least 0")):
            with tactus.Client(self.server.address) as client:
                stream = client.open(FOREARM.replace(dtype="float32", scale=1.0))
                stream.push(numpy.zeros((16, 24), "float32"))
                with self.assertRaises(tactus.Error) as caught:
                    stream.push(frame)
                self.assertEqual(caught.exception.reason, reason)
                self.assertIn(word, str(caught.exception))
                self.assertIn("sequence", caught.exception.metadata)
                self.assertTrue(caught.exception.advice)
                with self.assertRaises(tactus.Error) as later:
                    stream.end_trial()
                self.assertEqual(later.exception.reason, reason)

    def test_times_that_fall(self):
        with tactus.Client(self.server.address) as client:
            stream = client.open(FOREARM)
            stream.push(touch(1)[0], 5)
            with self.assertRaises(tactus.Error) as caught:
                stream.push(touch(1)[0], 5)
        self.assertEqual(caught.exception.reason, "TIME_REGRESSION")


class ConfigErrorTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.server = Server()
        cls.addClassCleanup(cls.server.stop)

    def refused(self, reason, skin=FOREARM, **options):
        with tactus.Client(self.server.address) as client:
            with self.assertRaises(tactus.Error) as caught, client.stream(skin, **options):
                pass
        self.assertEqual(caught.exception.reason, reason)
        self.assertTrue(caught.exception.advice, reason)
        self.assertIn(f"[{reason}]", str(caught.exception))

    def test_skins_and_options(self):
        self.refused("MODEL_NOT_FOUND", model="nobody")
        self.refused("UNKNOWN_LAYOUT", tactus.Skin(name="nothing"))
        self.refused("INVALID_CONFIG", tactus.Skin(name="big", rows=65, columns=8))
        self.refused("INVALID_CONFIG", FOREARM.replace(scale=0))
        self.refused("INVALID_CONFIG", frames_per_message=0)
        self.refused("INVALID_CONFIG", frames_per_message=65)
        self.refused("INVALID_CONFIG", interval_frames=-1)
        self.refused("INVALID_CONFIG", cadence="sometimes")
        self.refused("INVALID_CONFIG", max_contacts=9)
        with self.assertRaises(tactus.Error):
            tactus.Skin(name="x", dtype="float64")
        with self.assertRaises(TypeError):
            tactus.Client(self.server.address).stream(FOREARM, no_such_option=1)

    def test_no_server(self):
        with tactus.Client(f"127.0.0.1:{free_port()}") as client:
            with self.assertRaises(tactus.Error) as caught:
                client.open(FOREARM)
        self.assertEqual(caught.exception.code, "UNAVAILABLE")
        self.assertIn("tactusd", caught.exception.advice)
        os.environ.pop("TACTUS_SERVER", None)
        with self.assertRaises(tactus.Error) as caught:
            tactus.Client()
        self.assertIn("TACTUS_SERVER", str(caught.exception))

    def test_a_server_without_a_data_directory(self):
        with tactus.Client(self.server.address) as client:
            with self.assertRaises(tactus.Error) as caught:
                client.create_dataset("arm")
            self.assertEqual(caught.exception.reason, "NO_DATA_DIRECTORY")
            self.assertIn("--data-dir", caught.exception.advice)
            with self.assertRaises(tactus.Error) as caught:
                list(client.contacts())
            self.assertEqual(caught.exception.reason, "NO_CONTACT_LOG")


class AccessTest(unittest.TestCase):
    """Tokens and TLS, given as trainctl takes them."""

    def test_tokens(self):
        with Server() as server:
            tokens = server.path / "tokens"
            token = server.path / "robot.token"
            token.write_text(run("trainctl", "tokens", "create", "--name=arm-7", "--role=robot",
                                 f"--file={tokens}").strip().splitlines()[-1] + "\n")
            server.flags = [f"--tokens={tokens}"]
            server.kill()
            server.start()
            with tactus.Client(server.address) as client:
                with self.assertRaises(tactus.Error) as caught:
                    client.open(FOREARM)
            self.assertEqual(caught.exception.reason, "UNAUTHENTICATED")
            self.assertIn("TACTUS_TOKEN_FILE", caught.exception.advice)
            with tactus.Client(server.address, token_file=token) as client, \
                    client.stream(FOREARM) as stream:
                self.assertEqual(len(stream.push(touch(1)[0])), 1)
                with self.assertRaises(tactus.Error) as caught:
                    client.create_dataset("arm")
                self.assertEqual(caught.exception.reason, "PERMISSION_DENIED")
            os.environ["TACTUS_TOKEN_FILE"] = str(token)
            os.environ["TACTUS_SERVER"] = server.address
            try:
                with tactus.Client() as client, client.stream(FOREARM) as stream:
                    stream.push(touch(1)[0])
            finally:
                del os.environ["TACTUS_TOKEN_FILE"], os.environ["TACTUS_SERVER"]

    def test_a_token_stays_on_this_host(self):
        with self.assertRaises(tactus.Error) as caught:
            tactus.Client("arm.lab:50051", token="secret")
        self.assertEqual(caught.exception.reason, "INVALID_CONFIG")
        self.assertNotIn("secret", str(caught.exception))
        with self.assertRaises(tactus.Error) as caught:
            tactus.Client("unix:/tmp/a", token_file="/no/such/file")
        self.assertEqual(caught.exception.reason, "IO")

    def test_tls(self):
        import subprocess

        with Server() as server:
            certificate, key = server.path / "server.crt", server.path / "server.key"
            subprocess.run(
                ["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt",
                 "ec_paramgen_curve:prime256v1", "-nodes", "-days", "2", "-subj",
                 "/CN=localhost", "-addext", "subjectAltName=DNS:localhost", "-keyout", key,
                 "-out", certificate], check=True, capture_output=True)
            server.flags = [f"--tls-cert={certificate}", f"--tls-key={key}"]
            server.kill()
            server.start()
            address = f"localhost:{server.port}"
            with tactus.Client(address, tls_ca=certificate) as client, \
                    client.stream(FOREARM) as stream:
                self.assertEqual(len(stream.push(touch(1)[0])), 1)
            with tactus.Client(address) as client:
                with self.assertRaises(tactus.Error) as caught:
                    client.open(FOREARM)
            self.assertIn("tls_ca=", caught.exception.advice)
            with self.assertRaises(tactus.Error) as caught:
                tactus.Client(address, tls_ca=key)
            self.assertEqual(caught.exception.reason, "IO")

    def test_unix_sockets(self):
        with Server() as server:
            server.flags = [f"--listen=unix:{server.path}/s"]
            server.kill()
            server.start()
            with tactus.Client(f"unix:{server.path}/s", token="x") as client, \
                    client.stream(FOREARM) as stream:
                self.assertEqual(len(stream.push(touch(1)[0])), 1)


if __name__ == "__main__":
    unittest.main()
