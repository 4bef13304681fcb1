"""Trials: labelled contacts as numpy arrays, and the files that hold them."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Dict, Optional, Tuple

import numpy
import numpy.typing

from tactus._errors import Error
from tactus._skin import TAXEL_TYPES, Skin, from_geometry, to_geometry
from tactus.v1 import common_pb2, trial_pb2

Array = "numpy.typing.NDArray[Any]"

_UNITS = {"newton": common_pb2.TAXEL_UNIT_NEWTON, "counts": common_pb2.TAXEL_UNIT_COUNTS}
_DTYPES = {number: name for name, number in TAXEL_TYPES.items()}


@dataclass(frozen=True, eq=False)
class Touch:
    """One of several contacts in a trial."""

    #: The first and the last time with force, in seconds as ``Trial.time``.
    begin_s: float
    end_s: float
    label: str
    #: Fractional row and column of its middle; both or none.
    row: Optional[float] = None
    column: Optional[float] = None
    object: str = ""
    material: str = ""
    #: N/m; 0 if unknown.
    stiffness: float = 0.0
    #: Metres that the object has moved, one for each time from begin to end.
    object_motion: Optional["numpy.typing.NDArray[Any]"] = None


@dataclass(frozen=True, eq=False)
class Trial:
    """One labelled contact, or several. T is the number of frames.

    >>> trial = Trial(taxels=numpy.zeros((50, 16, 24), numpy.uint16), label="HU",
    ...               skin=Skin(name="cody-forearm", scale=0.001))
    >>> trial.frames, float(trial.time[-1])
    (50, 0.49)
    """

    #: [T, rows, columns(, 3)] of the skin's dtype; times ``skin.scale`` in its
    #: unit. None for a trial of signals alone.
    taxels: Optional["numpy.typing.NDArray[Any]"] = None
    #: The class, such as "HU".
    label: str = ""
    #: The skin of the taxels. Its rate is the trial's.
    skin: Optional[Skin] = None
    #: 1 to 64 letters, digits, - or _; empty: an upload numbers it.
    id: str = ""
    #: [T] seconds, increasing; None: one sample period apart.
    time: "numpy.typing.NDArray[Any]" = None  # type: ignore[assignment]
    #: [T, 3] force (unit), area (m^2), motion (m).
    signals: Optional["numpy.typing.NDArray[Any]"] = None
    #: [T, 7] x, y, z (m) and the quaternion qx, qy, qz, qw of the skin's link.
    poses: Optional["numpy.typing.NDArray[Any]"] = None
    #: [T] metres that the object has moved.
    object_motion: Optional["numpy.typing.NDArray[Any]"] = None
    #: Robot condition; what was touched, and of what it is made.
    condition: str = ""
    object: str = ""
    material: str = ""
    #: N/m and m/s; 0 if unknown.
    stiffness: float = 0.0
    velocity: float = 0.0
    #: Name of the recording that it was made from.
    source: str = ""
    #: Of trials without a skin.
    rate_hz: float = 0.0
    unit: str = ""
    touches: Tuple[Touch, ...] = field(default=())

    def __post_init__(self) -> None:
        if self.taxels is None and self.signals is None:
            raise _wrong(self, "taxels", "missing", "given, or signals")
        if self.taxels is not None:
            if self.skin is None:
                raise _wrong(self, "skin", "missing", "given with taxels")
            shape = self.skin.shape
            if self.taxels.ndim != len(shape) + 1 or self.taxels.shape[1:] != shape:
                raise _wrong(self, "taxels.shape", self.taxels.shape,
                             f"(frames, {', '.join(map(str, shape))})")
            if self.taxels.dtype.name != self.skin.dtype:
                raise _wrong(self, "taxels.dtype", self.taxels.dtype.name,
                             f"{self.skin.dtype}, as skin.dtype says")
        if not self.rate_hz:
            object.__setattr__(self, "rate_hz", self.skin.rate_hz if self.skin else 100.0)
        if not self.unit:
            object.__setattr__(self, "unit",
                               self.skin.resolved().unit if self.skin else "newton")
        array: Any = self.signals if self.taxels is None else self.taxels
        if self.time is None:
            object.__setattr__(self, "time", numpy.arange(len(array)) / self.rate_hz)
        widths: Dict[str, Tuple[int, ...]] = {
            "time": (), "signals": (3,), "poses": (7,), "object_motion": ()}
        if self.taxels is not None:
            widths["taxels"] = self.taxels.shape[1:]
        for name, width in widths.items():
            values = getattr(self, name)
            right = (len(self.time), *width)
            if values is not None and values.shape != right:
                raise _wrong(self, f"{name}.shape", values.shape, str(right))

    @property
    def frames(self) -> int:
        """T."""
        return len(self.time)

    @property
    def loads(self) -> "numpy.typing.NDArray[numpy.float32]":
        """[T, rows, columns(, 3)] the taxels in the skin's unit, as models see
        them: the product in double precision, rounded once."""
        if self.taxels is None or self.skin is None:
            raise _wrong(self, "taxels", "missing", "given")
        if self.taxels.dtype == numpy.float32:
            return self.taxels
        return (self.taxels * float(self.skin.scale)).astype(numpy.float32)

    def to_pandas(self) -> Any:
        """A pandas.DataFrame with a row for each frame: the index is the time in
        seconds; columns are the signals, the total and the largest load, and
        the poses."""
        import pandas

        columns = {}
        if self.signals is not None:
            for i, name in enumerate(("force", "area", "motion")):
                columns[name] = self.signals[:, i]
        if self.taxels is not None:
            loads = self.loads.reshape(self.frames, -1)
            columns["total"] = loads.sum(axis=1, dtype=float)
            columns["largest"] = loads.max(axis=1).astype(float)
        if self.poses is not None:
            for i, name in enumerate(("x", "y", "z", "qx", "qy", "qz", "qw")):
                columns[name] = self.poses[:, i]
        if self.object_motion is not None:
            columns["object_motion"] = self.object_motion
        return pandas.DataFrame(columns, index=pandas.Index(self.time, name="time_s"))


def _wrong(trial: Trial, what: str, value: object, expected: str) -> Error:
    name = f"trial {trial.id or trial.source}: " if trial.id or trial.source else ""
    return Error(f"{name}{what} is {value}; it must be {expected}", reason="INVALID_TRIAL",
                 metadata={"field": what, "value": str(value), "expected": expected})


def to_record(trial: Trial, name: str) -> bytes:
    """A serialised ``tactus.v1.TrialRecord``, with ``name`` for an id."""
    record = _record_without_taxels(trial, name)
    if trial.taxels is not None:
        little = trial.taxels.dtype.newbyteorder("<")
        record.taxels = trial.taxels.astype(little, copy=False).tobytes()
    serialised: bytes = record.SerializeToString()
    return serialised


def borrowed_record(trial: Trial, name: str) -> bytes:
    """The same without the values of the taxels, which stay in their array."""
    serialised: bytes = _record_without_taxels(trial, name).SerializeToString()
    return serialised


def _record_without_taxels(trial: Trial, name: str) -> Any:
    record: Any = trial_pb2.TrialRecord(
        id=name, label=trial.label, condition=trial.condition, object=trial.object,
        material=trial.material, stiffness=trial.stiffness, velocity=trial.velocity,
        sample_rate_hz=trial.rate_hz, unit=_UNITS[trial.unit], source=trial.source)
    record.time.extend(trial.time.tolist())
    for field_name in ("signals", "poses", "object_motion"):
        values = getattr(trial, field_name)
        if values is not None:
            getattr(record, field_name).extend(
                numpy.asarray(values, float).reshape(-1).tolist())
    if trial.taxels is not None and trial.skin is not None:
        record.geometry.CopyFrom(to_geometry(trial.skin))
        record.taxel_type = TAXEL_TYPES[trial.skin.dtype]
        record.scale = 0.0 if trial.skin.dtype == "float32" else trial.skin.scale
    for touch in trial.touches:
        made = record.touches.add(
            begin_s=touch.begin_s, end_s=touch.end_s, label=touch.label, row=touch.row,
            column=touch.column, object=touch.object, material=touch.material,
            stiffness=touch.stiffness)
        if touch.object_motion is not None:
            made.object_motion.extend(touch.object_motion.tolist())
    return record


def from_record(record: Any) -> Trial:
    """The trial of a ``tactus.v1.TrialRecord``."""
    skin = taxels = None
    frames = len(record.time)
    if record.taxels:
        dtype = _DTYPES[record.taxel_type]
        skin = from_geometry(record.geometry, dtype=dtype, scale=record.scale or 1.0,
                             rate_hz=record.sample_rate_hz, with_poses=bool(record.poses))
        taxels = numpy.frombuffer(record.taxels, numpy.dtype(dtype).newbyteorder("<")).astype(
            dtype, copy=False).reshape(frames, *skin.shape)

    def array(values: Any, width: int) -> Any:
        if not values:
            return None
        made = numpy.array(values, float)
        return made if width == 1 else made.reshape(frames, width)

    return Trial(
        taxels=taxels, label=record.label, skin=skin, id=record.id,
        time=numpy.array(record.time, float), signals=array(record.signals, 3),
        poses=array(record.poses, 7), object_motion=array(record.object_motion, 1),
        condition=record.condition, object=record.object, material=record.material,
        stiffness=record.stiffness, velocity=record.velocity, source=record.source,
        rate_hz=record.sample_rate_hz,
        unit="counts" if record.unit == common_pb2.TAXEL_UNIT_COUNTS else "newton",
        touches=tuple(Touch(
            touch.begin_s, touch.end_s, touch.label,
            touch.row if touch.HasField("row") else None,
            touch.column if touch.HasField("column") else None, touch.object, touch.material,
            touch.stiffness, array(touch.object_motion, 1)) for touch in record.touches))
