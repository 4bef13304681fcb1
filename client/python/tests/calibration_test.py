"""Calibration and tare, against a taxel-by-taxel computation of the formulas in
client/drivers/calibrated_driver.h."""

import json
import math
import struct
import unittest

import numpy

import tactus
from support import Server
from tactus._calibration import Loads

PALM = tactus.Skin(name="palm", rows=3, columns=4, row_pitch_m=0.005, column_pitch_m=0.005,
                   taxel_area_m2=25e-6, contact_threshold=0.01, onset_threshold=0.02,
                   scale=0.001)
TRIAXIAL = PALM.replace(axes=3, normal_axis=2, signed_values=True, dtype="int16")


def rounded(value):
    """A double as the nearest single."""
    return struct.unpack("<f", struct.pack("<f", value))[0]


def calibration_of(skin, seed, **changes):
    """A file of trainctl skin calibrate."""
    random = numpy.random.default_rng(seed)
    taxels, values = 12, 12 * skin.axes
    made = {
        "format": "tactus-calibration", "version": 1, "device": "test",
        "layout": {
            "layout": "palm", "rows": 3, "columns": 4, "row_pitch_m": 0.005,
            "column_pitch_m": 0.005, "taxel_area_m2": 25e-6, "unit": "TAXEL_UNIT_NEWTON",
            "contact_threshold": 0.01, "onset_threshold": 0.02},
        "created_ms": 0, "frames": 300, "sample_rate_hz": 100.0,
        "baseline": list(random.uniform(10, 50, values)), "deviation": [0.7] * values,
        "contact_threshold": [3.5] * taxels, "onset_threshold": [7.0] * taxels,
        "gains": [], "dead": [], "stuck": [], "noisy": []}
    if skin.axes == 3:
        made["layout"].update(axes=3, normal_axis=2, signed_values=True)
    made.update(changes)
    return made


class CalibrationTest(unittest.TestCase):
    def load(self, values):
        import tempfile

        with tempfile.NamedTemporaryFile("w", suffix=".json") as file:
            json.dump(values, file)
            file.flush()
            return tactus.Calibration.load(file.name)

    def test_loads_of_one_axis(self):
        random = numpy.random.default_rng(1)
        curves = [None if i % 3 == 0 else
                  numpy.cumsum(random.uniform(0.1, 40, (1 + i % 4, 2)), axis=0).tolist()
                  for i in range(12)]
        for gains in ([], curves):
            values = calibration_of(PALM, 2, gains=gains, dead=[5])
            loads = Loads(PALM, self.load(values), 0, 0)
            self.assertEqual(loads.skin.masked_taxels, (5,))
            self.assertEqual(loads.skin.dtype, "float32")
            for _ in range(50):
                frame = random.integers(0, 200, (3, 4)).astype("uint16")
                right = []
                for i, number in enumerate(frame.reshape(-1)):
                    reading = float(number) - values["baseline"][i]
                    load = reading * 0.001
                    if gains and gains[i]:
                        begin = (0.0, 0.0)
                        for end in gains[i]:
                            if end[0] >= reading:
                                break
                            begin = end
                        else:
                            begin = gains[i][-2] if len(gains[i]) > 1 else (0.0, 0.0)
                            end = gains[i][-1]
                        slope = (end[1] - begin[1]) / (end[0] - begin[0])
                        load = begin[1] + (reading - begin[0]) * slope
                    load = max(load, 0.0) if reading >= 3.5 else 0.0
                    right.append(rounded(load))
                self.assertEqual(loads.of(frame).reshape(-1).tolist(), right)

    def test_loads_of_three_axes(self):
        random = numpy.random.default_rng(3)
        matrices = [random.uniform(-0.01, 0.01, (3, 3)).tolist() for _ in range(12)]
        for normal in (2, None):
            skin = TRIAXIAL.replace(normal_axis=normal)
            values = calibration_of(skin, 4, cross_axis=matrices,
                                    contact_threshold=[0.4] * 12)
            if normal is None:
                del values["layout"]["normal_axis"]
            loads = Loads(skin, self.load(values), 0, 0)
            felt = 0
            for _ in range(50):
                frame = random.integers(-300, 300, (3, 4, 3)).astype("int16")
                right = []
                for i in range(12):
                    r = [float(n) - values["baseline"][3 * i + k]
                         for k, n in enumerate(frame.reshape(12, 3)[i])]
                    m = matrices[i]
                    load = [m[k][0] * r[0] + m[k][1] * r[1] + m[k][2] * r[2] for k in range(3)]
                    size = (max(load[2], 0.0) if normal == 2 else
                            math.sqrt(load[0] * load[0] + load[1] * load[1] + load[2] * load[2]))
                    felt += size >= 0.4
                    right += [rounded(value) if size >= 0.4 else 0.0 for value in load]
                self.assertEqual(loads.of(frame).reshape(-1).tolist(), right)
            self.assertGreater(felt, 50)

    def test_drift_is_followed_and_held(self):
        values = calibration_of(PALM, 5, baseline=[20.0] * 12)
        loads = Loads(PALM, self.load(values), 0, 2.0)
        weight = -math.expm1(-1 / (2.0 * 100))
        drift = 0.0
        for _ in range(30):
            loads.of(numpy.full((3, 4), 21, "uint16"))
            drift += weight * (1.0 - drift)
        self.assertEqual(loads._drift.tolist(), [drift] * 12)
        touched = numpy.full((3, 4), 21, "uint16")
        touched[1, 1] = 90
        self.assertEqual(loads.of(touched)[1, 1], rounded((90 - 20.0 - drift) * 0.001))
        for _ in range(100):
            loads.of(numpy.full((3, 4), 21, "uint16"))
        self.assertEqual(loads._drift.tolist(), [drift] * 12)
        loads.of(numpy.full((3, 4), 21, "uint16"))
        self.assertNotEqual(loads._drift.tolist(), [drift] * 12)

    def test_a_tare_is_the_mean_and_refuses_a_touch(self):
        random = numpy.random.default_rng(6)
        idle = random.integers(30, 34, (40, 3, 4)).astype("uint16")
        loads = Loads(PALM, None, 40, 0)
        for frame in idle:
            self.assertIsNone(loads.of(frame))
        means = idle.reshape(40, 12).astype(float).sum(axis=0) / 40
        self.assertEqual(loads._baseline.tolist(), means.tolist())
        frame = numpy.full((3, 4), 100, "uint16")
        self.assertEqual(loads.of(frame).reshape(-1).tolist(),
                         [rounded((100 - mean) * 0.001) for mean in means])
        touched = idle.copy()
        touched[20:, 2, 1] += 40
        loads = Loads(PALM, None, 40, 0)
        with self.assertRaises(tactus.Error) as caught:
            for frame in touched:
                loads.of(frame)
        self.assertEqual(caught.exception.reason, "INVALID_TRAINING_DATA")
        self.assertIn("taxel 9 changed by 40", str(caught.exception))
        # The next frames are another try.
        for frame in idle:
            loads.of(frame)
        self.assertEqual(loads._baseline.tolist(), means.tolist())
        with self.assertRaises(tactus.Error) as caught:
            loads = Loads(PALM, self.load(calibration_of(PALM, 7, baseline=[20.0] * 12)), 40, 0)
            rested = idle - 12
            rested[:, 0, 0] += 30
            for frame in rested:
                loads.of(frame)
        self.assertIn("taxel 0 is off its baseline", str(caught.exception))

    def test_what_does_not_fit_is_refused(self):
        for change in ({"version": 2}, {"format": "x"}, {"baseline": [1.0]},
                       {"deviation": [-1.0] * 12}, {"gains": [None] * 3}, {"dead": [12]},
                       {"layout": 3}, {"gains": [[[1, 1], [1, 2]]] * 12}):
            with self.assertRaises(tactus.Error) as caught:
                Loads(PALM, self.load(calibration_of(PALM, 1, **change)), 0, 0)
            self.assertEqual(caught.exception.reason, "INVALID_CONFIG", change)
        calibration = self.load(calibration_of(PALM, 1))
        for skin in (PALM.replace(name="other"), PALM.replace(unit="counts"),
                     PALM.replace(columns=5), TRIAXIAL):
            with self.assertRaises(tactus.Error):
                Loads(skin, calibration, 0, 0)
        with self.assertRaises(tactus.Error):
            Loads(PALM, None, 10, 0)
        with self.assertRaises(tactus.Error):
            Loads(PALM, None, 0, 5.0)

    def test_a_stream_of_tared_frames(self):
        skin = tactus.Skin(name="cody-forearm", scale=0.001)
        with Server() as server, tactus.Client(server.address) as client, \
                client.stream(skin, tare=20) as stream:
            self.assertEqual(stream.skin.dtype, "float32")
            rest = numpy.full((16, 24), 500, "uint16")
            for _ in range(20):
                self.assertEqual(stream.push(rest), [])
            (answer,) = stream.push(rest)
            self.assertEqual(answer.contacts, ())
            rest[4, 4] += 200
            (answer,) = stream.push(rest)
            self.assertEqual([event.kind for event in answer.events], ["touched"])
            self.assertAlmostEqual(answer.main.patch.force, 0.2, places=6)


if __name__ == "__main__":
    unittest.main()
