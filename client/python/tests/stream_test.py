"""Streams to a real server."""

import asyncio
import json
import time
import unittest
import unittest.mock

import numpy

import tactus
from support import FOREARM, Server, run, touch
from tactus._stream import StreamCore


class StreamTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.server = Server()
        cls.addClassCleanup(cls.server.stop)

    def client(self, **options):
        client = tactus.Client(self.server.address, **options)
        self.addCleanup(client.close)
        return client

    def stream_touch(self, frames=100, client=None, **options):
        """All answers to a growing touch, and the final one."""
        answers = []
        with (client or self.client()).stream(FOREARM, **options) as stream:
            for frame in touch(frames):
                answers.extend(stream.push(frame))
            final = stream.end_trial()
            answers.extend(stream.poll())
        return answers, final

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
        self.assertTrue(stream.ended)

    def test_a_robot_may_write_to_its_frame_again(self):
        ours = []
        with self.client().stream(FOREARM, frames_per_message=4) as stream:
            frame = stream.skin.zeros()
            for right in touch(40):
                frame[:] = right
                ours.extend(stream.push(frame))
            final = stream.end_trial()
        answers, expected = self.stream_touch(40)
        self.assertEqual(repr(ours + [final]), repr(answers + [expected]))

    def test_all_ways_to_send_have_the_same_bits(self):
        answers, final = self.stream_touch()
        for options in ({"frames_per_message": 8}, {"frames_per_message": 64}, {"wait": False}):
            with self.subTest(**options):
                others, other = self.stream_touch(**options)
                self.assertEqual(repr(other), repr(final))
                # Without waiting, the server may leave interim answers out.
                shown = {a.sequence: repr(a) for a in others if a.superseded == 0}
                self.assertTrue(shown)
                for answer in answers:
                    if answer.sequence in shown:
                        self.assertEqual(shown[answer.sequence], repr(answer))
        plain, other = self.stream_touch(client=self.client(direct=False))
        self.assertEqual(repr(plain + [other]), repr(answers + [final]))
        with self.client().stream(FOREARM) as stream:
            many = stream.push_many(touch(100))
            self.assertEqual(repr(many + [stream.end_trial()]), repr(answers + [final]))

    def test_async_answers_have_the_same_bits(self):
        answers, final = self.stream_touch()

        async def stream_all():
            got = []
            async with self.client().stream(FOREARM) as stream:
                for i, frame in enumerate(touch(100)):
                    if i % 2:
                        async for answer in stream.push(frame):
                            got.append(answer)
                    else:
                        got.extend(await stream.push(frame))
                got.append(await stream.end_trial())
            self.assertTrue(stream.ended)
            return got

        self.assertEqual(repr(asyncio.run(stream_all())), repr(answers + [final]))

        async def stream_many():
            async with self.client().stream(FOREARM) as stream:
                got = await stream.push_many(touch(100))
                return got, await stream.end_trial()

        many, other = asyncio.run(stream_many())
        self.assertEqual(repr(other), repr(final))
        self.assertEqual(many[-1].sequence, 100)

    def test_async_answers_come_though_the_receiver_is_slow(self):
        deliver = StreamCore._deliver

        def late(core, shown, message):
            time.sleep(0.005)
            deliver(core, shown, message)

        async def stream():
            async with self.client().stream(FOREARM) as stream:
                sequences = [a.sequence for a in await stream.push_many(touch(20))]
                return sequences, await stream.end_trial()

        with unittest.mock.patch.object(StreamCore, "_deliver", late):
            sequences, final = asyncio.run(stream())
        self.assertEqual(sequences[-1], 20)
        self.assertTrue(final.is_final)

    def test_several_skins_in_one_loop(self):
        async def one(client, taxels):
            async with client.stream(FOREARM, client_id=f"skin-{taxels[0]}") as stream:
                for frame in touch(60, taxels):
                    await stream.push(frame)
                return repr(await stream.end_trial())

        async def three():
            client = self.client()
            return await asyncio.gather(*(one(client, t) for t in ((0, 1), (100, 101), (200,))))

        together = asyncio.run(three())
        alone = [asyncio.run(one(self.client(), t)) for t in ((0, 1), (100, 101), (200,))]
        self.assertEqual(together, alone)
        client = self.client()
        with client.stream(FOREARM) as left, client.stream(FOREARM) as right:
            for a, b in zip(touch(60, (0, 1)), touch(60, (100, 101))):
                left.push(a)
                right.push(b)
            self.assertEqual([repr(left.end_trial()), repr(right.end_trial())], alone[:2])

    def test_cadences(self):
        answers, _ = self.stream_touch()
        with_events = [a.sequence for a in answers if a.events]
        few, _ = self.stream_touch(cadence="events")
        self.assertEqual([a.sequence for a in few], with_events)
        tenth, _ = self.stream_touch(interval_frames=10)
        self.assertEqual([a.sequence for a in tenth],
                         sorted(set(with_events) | set(range(10, 101, 10))))

    def test_several_trials_and_lost_frames(self):
        with self.client().stream(FOREARM) as stream:
            for trial in range(2):
                for t, frame in enumerate(touch(40)):
                    answers = stream.push(frame, missing_before=3 if t == 10 else 0)
                self.assertEqual(answers[0].frames_missing, 3)
                self.assertEqual(answers[0].sequence, 43 * (trial + 1))
                final = stream.end_trial()
                self.assertEqual(final.main.id, trial + 1)
        self.assertEqual(stream.final, final)

    def test_taxels_poses_and_patches(self):
        skin = FOREARM.replace(with_poses=True)
        with self.client().stream(skin, with_taxels=True) as stream:
            self.assertIn("default", stream.info.model_version)
            for t, frame in enumerate(touch(30)):
                (answer,) = stream.push(frame, pose=(0, 0, 1e-4 * t, 0, 0, 0, 1))
            patch = answer.main.patch
            self.assertEqual(patch.taxels, (180, 181, 204, 205))
            self.assertEqual(patch.area_taxels, 4)
            self.assertAlmostEqual(patch.force, 4 * 20 * 29 * 0.001, places=5)
            self.assertIsNotNone(patch.centroid.world)
            self.assertIsNotNone(answer.main.motion_m)
            with self.assertRaises(tactus.FrameError) as caught:
                stream.push(frame)
            self.assertEqual(caught.exception.reason, "INVALID_POSE")

    def test_equal_answers_pickle_and_compare(self):
        import pickle

        _, final = self.stream_touch(50)
        self.assertEqual(pickle.loads(pickle.dumps(final)), final)
        with self.assertRaises(AttributeError):
            final.sequence = 3
        with self.assertRaises(AttributeError):
            final.main.nothing

    def test_a_grpc_without_the_layer_of_direct_calls(self):
        from unittest import mock

        from tactus import _call

        def changed(*_):
            raise TypeError("segregated_call() takes another argument")

        for how in (mock.patch.object(_call, "cygrpc", None),
                    mock.patch.object(_call.DirectCall, "__init__", changed)):
            with how:
                answers, final = self.stream_touch(20)
            self.assertEqual(len(answers), 20)
            self.assertTrue(final.is_final)

    def test_notice_of_another_rate(self):
        with self.client().stream(FOREARM) as stream:
            for t, frame in enumerate(touch(300)):
                stream.push(frame, 20_000_000 * t)
        self.assertEqual([notice.kind for notice in stream.notices], ["rate differs"])

    def test_sixty_four_contacts_as_the_cpp_client(self):
        path = self.server.path / "contacts.h5"
        scores = self.server.path / "scores.jsonl"
        run("trainctl", "simulate", "--protocol=random", "--contacts=64", "--skin=good",
            "--seed=11", f"--out={path}")
        run("tactus-stream", f"--server={self.server.address}", "--driver=replay",
            f"--data={path}", f"--posteriors={scores}", "--json")
        expected = [json.loads(line) for line in scores.read_text().splitlines()]
        recording = tactus.Recording(path)
        self.assertEqual(len(recording), 64)
        self.assertEqual(len(expected), 64)
        same = 0
        with self.client().stream(recording[0].skin, frames_per_message=32) as stream:
            for trial, line in zip(recording, expected):
                stream.push_many(trial.taxels, poses=trial.poses)
                final = stream.end_trial()
                self.assertEqual(trial.id, line["trial"])
                if final.main is None:
                    self.assertEqual(line["probability"], [])
                    continue
                self.assertEqual(list(final.main.classes.values()), line["probability"])
                same += 1
        self.assertGreater(same, 50)


if __name__ == "__main__":
    unittest.main()
