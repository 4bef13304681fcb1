"""The skin of arrays that come without one."""

from __future__ import annotations

from typing import Any, List, Sequence

import numpy
import numpy.typing

from tactus._errors import Error, invalid
from tactus._skin import TAXEL_TYPES, Skin

Array = numpy.typing.NDArray[Any]

_PITCH_M = 0.005
# The rule of an import with idle taxels (core/import/idle_noise.h).
_IDLE_TAXELS = 0.25
_LEAST_MARGIN = 0.02


def inferred_skin(X: Sequence[Array]) -> Skin:
    """A skin for recordings [frames, rows, columns(, 3)]: flat, 5 mm between its
    taxels, values as they are ("counts"), 100 frames per second.

    The quarter of the taxels of each recording that read least tell how much
    the skin reads while nothing touches it. The margin is half of the distance
    from the median of that to its 99.9th percentile, or 2 % of what the median
    recording reads at most if that is more. The thresholds are one and two
    margins above the percentile; above 0 if that would exceed half of what is
    read at most: the whole skin was touched.
    """
    if len(X) == 0:
        raise invalid("number of recordings", 0, "1 or more", reason="INVALID_TRAINING_DATA")
    arrays = [numpy.asarray(frames) for frames in X]
    shapes = sorted({array.shape[1:] for array in arrays})
    types = sorted({array.dtype.name for array in arrays})
    if len(shapes) > 1 or len(types) > 1:
        raise Error(f"the recordings have frames of {_some(shapes)} and values of {_some(types)}",
                    reason="INVALID_TRAINING_DATA",
                    advice="a model is of one skin: fit one for each, or say with skin= what the "
                           "recordings are of")
    shape, dtype = shapes[0], types[0]
    if len(shape) not in (2, 3) or (len(shape) == 3 and shape[2] != 3):
        raise Error(f"a recording is of shape {arrays[0].shape}; it must be (frames, rows, "
                    "columns) or (frames, rows, columns, 3)", reason="INVALID_TRAINING_DATA")
    if dtype not in TAXEL_TYPES:
        raise invalid("dtype of the recordings", dtype,
                      "uint16, int16 or float32: X.astype(numpy.float32)",
                      reason="INVALID_TRAINING_DATA")
    rows, columns = shape[:2]
    contact, onset = _thresholds([_loads(array) for array in arrays if len(array)])
    return Skin(
        name=f"grid-{rows}x{columns}", rows=rows, columns=columns, row_pitch_m=_PITCH_M,
        column_pitch_m=_PITCH_M, taxel_area_m2=_PITCH_M * _PITCH_M, unit="counts",
        contact_threshold=contact, onset_threshold=onset, axes=3 if len(shape) == 3 else 1,
        # int16 is for skins that have them.
        signed_values=dtype == "int16" or any(bool((array < 0).any()) for array in arrays),
        dtype=dtype)


def _loads(array: Array) -> Array:
    """[frames, taxels] the distance of each taxel's values from 0."""
    values = numpy.abs(array.astype(numpy.float32))
    if array.ndim == 4:
        values = numpy.sqrt((values * values).sum(axis=3))
    return values.reshape(len(values), -1)


def _thresholds(recordings: List[Array]) -> Any:
    peaks = [float(loads.max()) for loads in recordings]
    peak = float(numpy.median(peaks)) if peaks else 0.0
    if not 0 < peak < numpy.inf:
        raise Error("the recordings read nothing above 0, or no numbers",
                    reason="INVALID_TRAINING_DATA")
    idle = []
    for loads in recordings:
        count = max(1, int(_IDLE_TAXELS * loads.shape[1]))
        quiet = numpy.argsort(loads.mean(axis=0), kind="stable")[:count]
        idle.append(loads[:, quiet].reshape(-1))
    values = numpy.concatenate(idle)
    high = float(numpy.percentile(values, 99.9))
    margin = max((high - float(numpy.median(values))) / 2, _LEAST_MARGIN * peak)
    if high + margin > peak / 2:
        high, margin = 0.0, _LEAST_MARGIN * peak
    return high + margin, high + 2 * margin


def _some(found: Sequence[object]) -> str:
    text = ", ".join(map(str, found[:4]))
    return text + (", ..." if len(found) > 4 else "")
