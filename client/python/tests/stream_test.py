"""Streams to a real server."""

import unittest

import numpy

import tactus
from support import FOREARM, Server, touch


class StreamTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.server = Server()
        cls.addClassCleanup(cls.server.stop)

    def client(self, **options):
        client = tactus.Client(self.server.address, **options)
        self.addCleanup(client.close)
        return client

    def test_each_frame_has_its_answer(self):
        with self.client().stream(FOREARM) as stream:
            for t, frame in enumerate(touch(60)):
                answers = stream.push(frame)
                self.assertEqual([answer.sequence for answer in answers], [t + 1])
                self.assertEqual(answers[0].capture_time_ns, 10_000_000 * t)
                self.assertFalse(answers[0].is_final)
                numpy.testing.assert_array_equal(answers[0].frame, frame)
            final = stream.end_trial()
        self.assertTrue(final.is_final)
        self.assertAlmostEqual(sum(final.main.classes.values()), 1, places=9)
        self.assertEqual(set(final.main.answers), {"hardness", "mobility"})
        self.assertEqual([event.kind for event in stream.events()][:1], ["touched"])
        self.assertEqual(stream.statistics.frames, 60)


if __name__ == "__main__":
    unittest.main()
