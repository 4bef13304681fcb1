"""Calibration and tare: what a skin sends, as loads.

The numbers are those of the C++ client (client/drivers/calibrated_driver.h), with
the same bits: all in double precision, rounded once to single.
"""

from __future__ import annotations

import json
import math
import os
from dataclasses import dataclass
from typing import Any, List, Optional, Tuple, Union

import numpy
import numpy.typing
from google.protobuf import json_format

from tactus._errors import Error, invalid
from tactus._frames import FrameWriter
from tactus._skin import Skin, from_geometry
from tactus.v1 import common_pb2

Array = numpy.typing.NDArray[Any]

_MAX_VALUE = 1e12
_LEAST_TARE_FRAMES = 20
_PARTS = 4
_DEVIATIONS_PER_MEDIAN = 1.4826
_SHEAR_DEVIATIONS = 6.0
_HOLD_S = 1.0


@dataclass(frozen=True, eq=False)
class Calibration:
    """What ``trainctl skin calibrate`` measured of a skin::

        calibration = tactus.Calibration.load("cal.json")
        with client.stream(skin, calibration=calibration, tare=100) as stream:
            stream.push(numbers_as_the_skin_sends_them)
    """

    #: Names the skin and how it is connected.
    device: str
    #: The skin as it was calibrated.
    skin: Skin
    #: [values] mean and standard deviation at rest, in the numbers that the
    #: skin sends; a value is a taxel along an axis.
    baseline: Array
    deviation: Array
    #: [taxels] of a taxel's load above the baseline.
    contact_threshold: Array
    onset_threshold: Array
    #: For each taxel None or [points, 2], readings and loads; empty: loads are
    #: readings times ``skin.scale``.
    gains: Tuple[Optional[Array], ...]
    #: None, one or one per taxel of [3, 3]: loads of readings.
    cross_axis: Tuple[Optional[Array], ...]
    #: Indices of taxels that are masked.
    faulty: Tuple[int, ...]

    @staticmethod
    def load(path: Union[str, "os.PathLike[str]"]) -> "Calibration":
        """Reads a file of ``trainctl skin calibrate``. IO, INVALID_CONFIG."""
        try:
            with open(path, encoding="utf-8") as file:
                values = json.load(file)
        except OSError as error:
            raise Error(f"{path}: {error.strerror}", reason="IO", code="UNAVAILABLE",
                        metadata={"path": str(path)}) from error
        except ValueError as error:
            raise invalid("calibration", f"no JSON ({error})", "an object in JSON") from error
        return _calibration_of(values)


def _calibration_of(values: Any) -> Calibration:
    if not isinstance(values, dict) or values.get("format") != "tactus-calibration":
        raise invalid("format", "another", "tactus-calibration")
    if values.get("version") != 1:
        raise invalid("version", values.get("version"), "1")
    try:
        geometry = json_format.ParseDict(values["layout"], common_pb2.SensorGeometry())
        skin = from_geometry(geometry).resolved()
        made = Calibration(
            device=values["device"], skin=skin,
            baseline=numpy.array(values["baseline"], float),
            deviation=numpy.array(values["deviation"], float),
            contact_threshold=numpy.array(values["contact_threshold"], float),
            onset_threshold=numpy.array(values["onset_threshold"], float),
            gains=tuple(None if curve is None else numpy.array(curve, float).reshape(-1, 2)
                        for curve in values["gains"]),
            cross_axis=tuple(None if matrix is None else numpy.array(matrix, float).reshape(3, 3)
                             for matrix in values.get("cross_axis", ())),
            faulty=tuple(sorted({*values["dead"], *values["stuck"], *values["noisy"]})))
    except (KeyError, TypeError, ValueError, json_format.ParseError) as error:
        raise invalid("calibration", f"incomplete ({error!r})",
                      "a file of trainctl skin calibrate") from error
    taxels = skin.rows * skin.columns
    for name, numbers, count, least in (
            ("baseline", made.baseline, taxels * skin.axes, -_MAX_VALUE),
            ("deviation", made.deviation, taxels * skin.axes, 0),
            ("contact_threshold", made.contact_threshold, taxels, 0),
            ("onset_threshold", made.onset_threshold, taxels, 0)):
        if numbers.shape != (count,):
            raise invalid(f"numbers of {name}", numbers.size, str(count))
        if not ((numbers >= least) & (numbers <= _MAX_VALUE)).all():
            raise invalid(name, "out of range", f"from {least:g} to {_MAX_VALUE:g}")
    if made.gains and (len(made.gains) != taxels or skin.axes != 1):
        raise invalid("gains", len(made.gains), f"none, or {taxels} on a skin of one axis")
    if made.cross_axis and (len(made.cross_axis) not in (1, taxels) or skin.axes != 3):
        raise invalid("cross_axis", len(made.cross_axis),
                      f"none, 1 or {taxels} on a skin of three axes")
    if made.faulty and not 0 <= made.faulty[0] <= made.faulty[-1] < taxels:
        raise invalid("faulty taxels", made.faulty, f"below {taxels}")
    return made


class _Curves:
    """The gain curves of all taxels, evaluated together."""

    def __init__(self, gains: Tuple[Optional[Array], ...]) -> None:
        self.has = numpy.array([curve is not None for curve in gains])
        most = max(len(curve) for curve in gains if curve is not None) if self.has.any() else 1
        # Before the first point is (0, 0); behind the last nothing is searched.
        self._readings = numpy.full((len(gains), most + 1), numpy.inf)
        self._loads = numpy.zeros((len(gains), most + 1))
        self._last = numpy.ones(len(gains), int)
        for i, curve in enumerate(gains):
            points = numpy.array([[1.0, 1.0]]) if curve is None else curve
            steps = numpy.diff(points, axis=0, prepend=[[0, 0]])
            if not len(points) or not (steps > 0).all() or not numpy.isfinite(points).all():
                raise invalid(f"gain curve of taxel {i}", points.tolist(),
                              "finite, with readings and loads that rise from above 0")
            self._readings[i, 0] = 0
            self._readings[i, 1:len(points) + 1] = points[:, 0]
            self._loads[i, 1:len(points) + 1] = points[:, 1]
            self._last[i] = len(points)
        self._taxels = numpy.arange(len(gains))

    def of(self, readings: Array) -> Array:
        above = (self._readings[:, 1:] < readings[:, None]).sum(axis=1) + 1
        end = numpy.minimum(above, self._last)
        at = self._taxels
        begin_reading, begin_load = self._readings[at, end - 1], self._loads[at, end - 1]
        slope = (self._loads[at, end] - begin_load) / (self._readings[at, end] - begin_reading)
        loads: Array = begin_load + (readings - begin_reading) * slope
        return loads


class Loads:
    """Frames as a skin sends them, as loads. Belongs to one stream."""

    def __init__(self, skin: Skin, calibration: Optional[Calibration], tare: int,
                 drift_s: float) -> None:
        self._raw = raw = skin.resolved()
        if tare and tare < _LEAST_TARE_FRAMES:
            raise invalid("tare", tare, f"{_LEAST_TARE_FRAMES} frames or more")
        if drift_s > 0 and calibration is None:
            raise invalid("calibration", "absent", "given to follow the drift: it has the "
                          "thresholds that show a contact")
        if calibration is not None:
            _check_fits(calibration, raw)
        self._calibration = calibration
        self._tare = tare
        self._tared: List[Array] = []
        self._writer = FrameWriter(raw)
        faulty = calibration.faulty if calibration else ()
        masked = tuple(sorted({*raw.masked_taxels, *faulty}))
        #: What the stream's frames are like.
        self.skin = raw.replace(dtype="float32", scale=1.0, masked_taxels=masked)
        self._taxels = raw.rows * raw.columns
        self._mask = numpy.ones(self._taxels, bool)
        self._mask[list(masked)] = False
        self._both_ways = raw.axes > 1 or raw.signed_values
        self._baseline = (calibration.baseline if calibration
                          else numpy.zeros(self._taxels * raw.axes))
        self._gate: Any = 0.0
        if calibration is not None and raw.light_touch is None:
            self._gate = calibration.contact_threshold
        self._curves = _Curves(calibration.gains) if calibration and calibration.gains else None
        self._matrix, self._has_matrix = _matrices(calibration, self._taxels)
        self._along = self._thresholds_along()
        self._drift = numpy.zeros(self._taxels * raw.axes) if drift_s > 0 else None
        self._weight = -math.expm1(-1 / (drift_s * raw.rate_hz)) if drift_s > 0 else 0.0
        self._hold = math.ceil(_HOLD_S * raw.rate_hz)
        self._held = 0

    def of(self, frame: Any) -> Optional[Array]:
        """The loads of a frame; None while the skin is tared."""
        self._writer.check(frame)
        numbers = frame.reshape(-1).astype(numpy.float32)
        if self._tare:
            self._tared.append(numbers)
            if len(self._tared) == self._tare:
                self._finish_tare()
            return None
        above = numbers.astype(float) - self._baseline
        if self._drift is not None:
            self._follow(above, self._drift)
            above = above - self._drift
        loads = self._of_readings(above)
        felt = self._normal(loads) >= self._gate
        return numpy.where(felt[:, None], self._along_axes(loads), numpy.float32(0)).astype(
            numpy.float32).reshape(self.skin.shape)

    def _of_readings(self, above: Array) -> Array:
        """[taxels, axes] loads by the matrices; readings without one."""
        readings = above.reshape(self._taxels, -1)
        if self._matrix is None:
            return readings
        x, y, z = readings.T
        loads = numpy.stack([self._matrix[:, i, 0] * x + self._matrix[:, i, 1] * y
                             + self._matrix[:, i, 2] * z for i in range(3)], axis=1)
        return numpy.where(self._has_matrix[:, None], loads, readings)

    def _normal(self, loads: Array) -> Array:
        made: Array
        if not self._both_ways:
            made = loads[:, 0]
        elif self._raw.normal_axis is not None:
            made = numpy.maximum(loads[:, self._raw.normal_axis], 0.0)
        elif self._raw.axes == 1:
            made = numpy.abs(loads[:, 0])
        else:
            x, y, z = loads.T
            made = numpy.sqrt(x * x + y * y + z * z)
        return made

    def _along_axes(self, loads: Array) -> Array:
        scaled = loads * self._raw.scale
        if self._curves is not None:
            scaled = numpy.where(self._curves.has[:, None],
                                 self._curves.of(loads[:, 0])[:, None], scaled)
        if self._matrix is not None:
            scaled = numpy.where(self._has_matrix[:, None], loads, scaled)
        least = -_MAX_VALUE if self._raw.signed_values else 0.0
        # The sum has no negative zero.
        return numpy.clip(scaled, least, _MAX_VALUE).astype(numpy.float32) + numpy.float32(0)

    # The drift of untouched taxels.

    def _follow(self, above: Array, drift: Array) -> None:
        readings = above - drift
        if (self._excess(readings)[self._mask] >= 0).any():
            self._held = self._hold + 1
        if self._held > 0:
            self._held -= 1
            return
        drift += self._weight * readings

    def _thresholds_along(self) -> Optional[Array]:
        """[taxels, axes] what counts as a touch along each axis."""
        calibration = self._calibration
        if calibration is None or not self._both_ways or self._raw.normal_axis is None:
            return None
        squares = calibration.deviation.reshape(self._taxels, -1) ** 2
        if self._matrix is not None:
            made = ((self._matrix ** 2) * squares[:, None, :]).sum(axis=2)
            squares = numpy.where(self._has_matrix[:, None], made, squares)
        noise = _SHEAR_DEVIATIONS * numpy.sqrt(squares)
        noise[:, self._raw.normal_axis] = 0
        return numpy.maximum(calibration.contact_threshold[:, None], noise)

    def _excess(self, readings: Array) -> Array:
        """[taxels] by how much loads are above what counts as a touch."""
        assert self._calibration is not None
        loads = self._of_readings(readings)
        excess: Array = self._normal(loads) - self._calibration.contact_threshold
        if self._along is not None:
            excess = numpy.maximum(excess, (numpy.abs(loads) - self._along).max(axis=1))
        return excess

    # The tare.

    def _finish_tare(self) -> None:
        frames, self._tared = numpy.stack(self._tared), []
        self._refuse_change(frames)
        # One frame after the other, as the C++ client adds them.
        baseline = numpy.zeros(frames.shape[1])
        for frame in frames:
            baseline += frame
        baseline /= len(frames)
        if self._calibration is not None:
            rises = baseline - self._calibration.baseline
            rises -= self._per_value(self._medians(rises))
            excess = self._excess(rises)
            for taxel in numpy.flatnonzero((excess > 0) & self._mask):
                raise _touched(taxel, "is off its baseline in the calibration; take everything "
                               "off the skin, or calibrate again")
        self._baseline = baseline
        self._tare = 0

    def _refuse_change(self, frames: Array) -> None:
        resolution = 0.0 if self._raw.dtype == "float32" else 1.0
        steps = numpy.abs(numpy.diff(frames, axis=0)).astype(float)
        middle = numpy.partition(steps, len(steps) // 2, axis=0)[len(steps) // 2]
        noise = _DEVIATIONS_PER_MEDIAN * middle / math.sqrt(2)
        noise = numpy.maximum(noise, numpy.maximum(
            0.3 * resolution, 0.25 * self._per_value(self._medians(noise))))
        count = len(frames)
        means = numpy.stack([
            frames[part * count // _PARTS:(part + 1) * count // _PARTS].mean(axis=0, dtype=float)
            for part in range(_PARTS)])
        change = means.max(axis=0) - means.min(axis=0)
        moved = (change > 6 * noise) & (change > 3 * resolution)
        moved &= numpy.repeat(self._mask, self._raw.axes)
        for value in numpy.flatnonzero(moved):
            raise _touched(value // self._raw.axes,
                           f"changed by {change[value]:.3g}, and its noise is "
                           f"{noise[value]:.3g}; take everything off the skin")

    def _medians(self, numbers: Array) -> Array:
        """[axes] of the taxels that count."""
        valid = numbers.reshape(self._taxels, -1)[self._mask]
        if not len(valid):
            return numpy.zeros(self._raw.axes)
        medians: Array = numpy.sort(valid, axis=0)[len(valid) // 2]
        return medians

    def _per_value(self, axes: Array) -> Array:
        return numpy.tile(axes, self._taxels)


def _touched(taxel: int, why: str) -> Error:
    return Error(f"the skin is touched: taxel {taxel} {why}, or mask the taxel",
                 reason="INVALID_TRAINING_DATA", code="FAILED_PRECONDITION",
                 metadata={"taxel": str(taxel)})


def _matrices(calibration: Optional[Calibration], taxels: int) -> Tuple[Any, Array]:
    """[taxels, 3, 3] the matrices, and which taxels have one."""
    if calibration is None or not calibration.cross_axis:
        return None, numpy.zeros(taxels, bool)
    given = calibration.cross_axis
    every = given * taxels if len(given) == 1 else given
    has = numpy.array([matrix is not None for matrix in every])
    return numpy.stack([numpy.zeros((3, 3)) if m is None else m for m in every]), has


def _check_fits(calibration: Calibration, skin: Skin) -> None:
    made = calibration.skin
    for name in ("name", "rows", "columns", "unit", "axes", "signed_values", "normal_axis"):
        if getattr(made, name) != getattr(skin, name):
            raise invalid(f"{name} of the calibration's skin", getattr(made, name),
                          f"{getattr(skin, name)}, as the skin in use")
    _, has = _matrices(calibration, skin.rows * skin.columns)
    if calibration.cross_axis:
        counts = numpy.ones(len(has), bool)
        counts[[*skin.masked_taxels, *calibration.faulty]] = False
        for taxel in numpy.flatnonzero(counts & ~has):
            raise invalid(f"cross_axis of taxel {taxel}", "absent", "given, or the taxel masked")
