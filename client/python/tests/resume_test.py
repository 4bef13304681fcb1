"""Streams that lose their server, killed at random frames."""

import asyncio
import os
import random
import signal
import threading
import time
import unittest

import tactus
from support import FOREARM, Server, touch

SEED = int(os.environ.get("TACTUS_SEED", random.randrange(10**6)))


class ResumeTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        print(f"TACTUS_SEED={SEED}", flush=True)

    def setUp(self):
        self.server = Server()
        self.addCleanup(self.server.stop)
        self.random = random.Random(SEED)
        self.restarts = []
        self.frames = touch(150, start=20)
        # The touch is let go in between, and the arm moves.
        self.frames[70:110] = 0
        self.expect(FOREARM)

    def pose(self, t):
        return (0, 0, 1e-4 * t, 0, 0, 0, 1) if self.skin.with_poses else None

    def expect(self, skin, **options):
        """What one unbroken stream answers."""
        self.skin = skin
        with tactus.Client(self.server.address) as client, \
                client.stream(skin, **options) as stream:
            self.expected = [a for t, frame in enumerate(self.frames)
                             for a in stream.push(frame, pose=self.pose(t))]
            self.expected.append(stream.end_trial())

    def kill_sometimes(self, t, at):
        if t in at:
            for restart in self.restarts:
                restart.join()
            self.server.kill()
            # It starts again while the robot goes on.
            self.restarts.append(threading.Timer(0.2, self.server.start))
            self.restarts[-1].start()
            self.addCleanup(self.restarts[-1].join)

    def wait_until(self, holds):
        while not holds():
            time.sleep(0.01)

    def check(self, answers, resumed, events_alone=False):
        self.assertEqual(resumed, 2)
        shown = [a for a in answers if a.superseded == 0]
        if not events_alone:
            self.assertGreater(len(shown), len(self.expected) // 2)
        self.assertEqual(len({a.sequence for a in answers if not a.is_final}),
                         len([a for a in answers if not a.is_final]), "an answer came twice")
        expected = {(a.sequence, a.is_final): repr(a) for a in self.expected}
        for answer in shown:
            self.assertEqual(repr(answer), expected[answer.sequence, answer.is_final])
        events = [e for a in answers for e in a.events]
        self.assertEqual(events, [e for a in self.expected for e in a.events])
        self.assertEqual(repr(answers[-1].contacts), repr(self.expected[-1].contacts))

    def stream(self, **options):
        kills = sorted(self.random.sample(range(5, 145), 1)) + [150]
        direct = options.pop("direct", None)
        answers = []
        with tactus.Client(self.server.address, direct=direct) as client, client.stream(
                self.skin, **options) as stream:
            for t, frame in enumerate(self.frames):
                self.kill_sometimes(t, kills)
                answers += stream.push(frame, pose=self.pose(t))
                # As a robot, which reads its skin while the stream is lost.
                while stream.resuming and self.random.random() < 0.95:
                    time.sleep(0.01)
            self.wait_until(lambda: stream.statistics.resumed == 1 and not stream.resuming)
            self.kill_sometimes(150, kills)
            final = stream.end_trial()
            answers += stream.poll() + [final]
            resumed = stream.statistics.resumed
        self.check(answers, resumed, options.get("cadence") == "events")

    def test_in_lockstep(self):
        self.stream()

    def test_through_the_public_interface_of_grpc(self):
        self.stream(direct=False)

    def test_with_a_thread(self):
        self.stream(wait=False)

    def test_in_messages_of_eight_frames(self):
        self.stream(frames_per_message=8)

    def test_with_poses(self):
        self.expect(FOREARM.replace(with_poses=True))
        self.stream()

    def test_each_third_answer(self):
        self.expect(FOREARM, interval_frames=3)
        self.stream(interval_frames=3)

    def test_with_light_touch(self):
        light = tactus.LightTouch(0.1, 3, 3, 0.0004, 0.00056)
        self.expect(FOREARM.replace(light_touch=light))
        self.stream()

    def test_events_alone(self):
        self.expect(FOREARM)
        self.stream(cadence="events")

    def test_async(self):
        kills = [self.random.randrange(5, 145), 150]

        async def stream_all():
            answers = []
            with tactus.Client(self.server.address) as client:
                async with client.stream(FOREARM) as stream:
                    for t, frame in enumerate(self.frames):
                        self.kill_sometimes(t, kills)
                        async for answer in stream.push(frame):
                            answers.append(answer)
                        while stream.resuming:
                            await asyncio.sleep(0.01)
                    while stream.statistics.resumed < 1 or stream.resuming:
                        await asyncio.sleep(0.01)
                    answers += await stream.poll()
                    self.kill_sometimes(150, kills)
                    final = await stream.end_trial()
                    answers += await stream.poll() + [final]
                    return answers, stream.statistics.resumed

        self.check(*asyncio.run(stream_all()))

    def test_a_server_that_stays_away(self):
        with tactus.Client(self.server.address, resume_for=1.0) as client:
            stream = client.open(FOREARM)
            for frame in self.frames[:30]:
                stream.push(frame)
            self.server.kill()
            with self.assertRaises(tactus.Error) as caught:
                for _ in range(10_000):
                    stream.push(self.frames[30])
                    time.sleep(0.005)
            self.assertEqual(caught.exception.reason, "NO_RESPONSE")
            self.assertIn("within 1 s", str(caught.exception))
            self.assertTrue(stream.ended)
            with self.assertRaises(tactus.Error):
                stream.close()

    def test_without_resumption_the_first_loss_ends_it(self):
        with tactus.Client(self.server.address, resume_for=0) as client:
            stream = client.open(FOREARM)
            stream.push(self.frames[0])
            self.server.kill()
            with self.assertRaises(tactus.Error) as caught:
                stream.push(self.frames[1])
            self.assertEqual(caught.exception.code, "UNAVAILABLE")

    def test_a_server_that_hangs(self):
        with tactus.Client(self.server.address, answer_timeout=0.5) as client, \
                client.stream(FOREARM) as stream:
            answers = [a for frame in self.frames[:50] for a in stream.push(frame)]
            self.server.process.send_signal(signal.SIGSTOP)
            threading.Timer(1.0, self.server.process.send_signal, (signal.SIGCONT,)).start()
            for frame in self.frames[50:]:
                answers += stream.push(frame)
            final = stream.end_trial()
            answers += stream.poll() + [final]
            self.assertGreaterEqual(stream.statistics.resumed, 1)
        self.assertEqual(repr(answers[-1].contacts), repr(self.expected[-1].contacts))
        self.assertEqual([e for a in answers for e in a.events],
                         [e for a in self.expected for e in a.events])

    def test_ctrl_c_ends_a_wait(self):
        with tactus.Client(self.server.address) as client:
            self.server.process.send_signal(signal.SIGSTOP)
            self.addCleanup(self.server.process.send_signal, signal.SIGCONT)
            threading.Timer(0.5, os.kill, (os.getpid(), signal.SIGINT)).start()
            with self.assertRaises(KeyboardInterrupt):
                client.open(FOREARM)
            self.server.process.send_signal(signal.SIGCONT)
            stream = client.open(FOREARM)
            stream.push(self.frames[0])
            self.server.process.send_signal(signal.SIGSTOP)
            threading.Timer(0.5, os.kill, (os.getpid(), signal.SIGINT)).start()
            with self.assertRaises(KeyboardInterrupt), stream:
                stream.push(self.frames[1])
            self.assertTrue(stream.ended)

    def test_what_is_kept_has_a_bound(self):
        with tactus.Client(self.server.address, replay_bytes=256 * 1024) as client, \
                client.stream(FOREARM) as stream:
            for _ in range(600):
                stream.push(self.frames[140])
            history = stream._link.history
            self.assertLessEqual(history.bytes, 256 * 1024)
            self.server.kill()
            threading.Timer(0.2, self.server.start).start()
            for _ in range(30):
                stream.push(self.frames[140])
            while stream.resuming:
                time.sleep(0.01)
            stream.push(self.frames[140])
            final = stream.end_trial()
            self.assertEqual(stream.statistics.without_beginning, 1)
            self.assertEqual(final.main.id, 2)


if __name__ == "__main__":
    unittest.main()
