"""What a robot's skin is like."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any, Optional, Tuple

import numpy
import numpy.typing

from tactus._errors import Error, invalid
from tactus.v1 import common_pb2

#: Numpy's name of a value, and its TaxelType on the wire.
TAXEL_TYPES = {"uint16": 1, "float32": 2, "int16": 3}

_UNITS = {"newton": 1, "counts": 2}


@dataclass(frozen=True)
class LightTouch:
    """How contacts are felt that are too light for a single taxel.

    By the mean of a region of taxels over a window of time, above its
    background. Thresholds are in the skin's unit.
    """

    #: Time constant of the mean over frames in seconds, 0.01 to 1.
    window_s: float
    #: Size of a region in taxels, 1 to 16.
    rows: int
    columns: int
    contact_threshold: float
    onset_threshold: float


@dataclass(frozen=True)
class Skin:
    """A skin, fixed for a whole stream.

    Without rows and columns, ``name`` is that of a preset ("cody-forearm",
    "vitac-12x32", "icub-6x10"), whose shape and unit are used; thresholds, mask
    and light touch that are given replace those of the preset.

    >>> forearm = Skin(name="cody-forearm", scale=0.001)  # millinewtons, uint16
    >>> palm = Skin(name="my-palm", rows=8, columns=8, row_pitch_m=0.005,
    ...             column_pitch_m=0.005, taxel_area_m2=25e-6,
    ...             contact_threshold=0.01, onset_threshold=0.02, dtype="float32")
    >>> palm.shape
    (8, 8)
    """

    #: Layout class. A model answers for skins of one class.
    name: str
    #: Taxels per side, 1 to 64; 0 for a preset.
    rows: int = 0
    columns: int = 0
    #: Metres between neighbours; columns along the circumference if they wrap.
    row_pitch_m: float = 0.0
    column_pitch_m: float = 0.0
    #: Square metres that one taxel stands for.
    taxel_area_m2: float = 0.0
    #: True if the last column is a neighbour of the first: a cylinder.
    wrap_columns: bool = False
    #: "newton" or "counts".
    unit: str = "newton"
    #: A taxel is touched if its load is at least the first of these; a contact
    #: begins once some taxel's is at least the second. In ``unit``.
    contact_threshold: float = 0.0
    onset_threshold: float = 0.0
    #: Row-major indices of taxels to ignore.
    masked_taxels: Tuple[int, ...] = ()
    #: Taxels that touch at a corner only are no neighbours.
    only_side_neighbours: bool = False
    light_touch: Optional[LightTouch] = None
    #: Values of a taxel: 1, its load; or 3, along x, y and z.
    axes: int = 1
    #: The axis that carries the load; None: the distance of the values from 0.
    normal_axis: Optional[int] = None
    #: Values may be below 0.
    signed_values: bool = False
    #: Row-major indices of taxels that carry something else than touch, such as
    #: the angle of a joint: inputs of models that were trained with them. If
    #: they may be below 0 and the others may not, set ``signed_values``, and
    #: ``normal_axis`` to 0.
    auxiliary_taxels: Tuple[int, ...] = ()
    #: Type of the values of a frame: "uint16", "int16" or "float32".
    dtype: str = "uint16"
    #: A frame's values times this are in ``unit``; above 0.
    scale: float = 1.0
    #: Frames per second.
    rate_hz: float = 100.0
    #: Every frame has a pose of the link that carries the skin.
    with_poses: bool = False

    def __post_init__(self) -> None:
        try:
            name = numpy.dtype(self.dtype).name
        except TypeError:
            name = str(self.dtype)
        if name not in TAXEL_TYPES:
            raise invalid("skin.dtype", name, "uint16, int16 or float32")
        object.__setattr__(self, "dtype", name)
        taxels = numpy.asarray(self.masked_taxels)
        if taxels.dtype == bool:
            if taxels.size != self.rows * self.columns and self.rows:
                raise invalid("skin.masked_taxels", f"of shape {taxels.shape}",
                              f"of shape {(self.rows, self.columns)}, or a list of indices")
            taxels = numpy.flatnonzero(taxels)
        object.__setattr__(self, "masked_taxels", tuple(int(taxel) for taxel in taxels))
        if self.unit not in _UNITS:
            raise invalid("skin.unit", self.unit, '"newton" or "counts"')

    @property
    def shape(self) -> Tuple[int, ...]:
        """Shape of a frame: (rows, columns), or (rows, columns, 3)."""
        whole = self.resolved()
        if whole.axes == 1:
            return (whole.rows, whole.columns)
        return (whole.rows, whole.columns, whole.axes)

    def resolved(self) -> "Skin":
        """The skin with all values of its preset filled in.

        >>> Skin(name="vitac-12x32").resolved().shape
        (12, 32)
        """
        if self.rows or self.columns:
            return self
        preset = PRESETS.get(self.name)
        if preset is None:
            raise Error(f"layout {self.name!r} is not a preset ({', '.join(PRESETS)}); describe "
                        "it in full, with rows and columns", reason="UNKNOWN_LAYOUT",
                        metadata={"field": "skin.name", "value": self.name,
                                  "expected": ", ".join(PRESETS)})
        return replace(
            preset, contact_threshold=self.contact_threshold or preset.contact_threshold,
            onset_threshold=self.onset_threshold or preset.onset_threshold,
            masked_taxels=self.masked_taxels, auxiliary_taxels=self.auxiliary_taxels,
            only_side_neighbours=self.only_side_neighbours,
            light_touch=self.light_touch, dtype=self.dtype, scale=self.scale,
            rate_hz=self.rate_hz, with_poses=self.with_poses)

    def replace(self, **changes: Any) -> "Skin":
        """A copy with other values."""
        return replace(self, **changes)

    def zeros(self) -> "numpy.typing.NDArray[Any]":
        """A frame of this skin, untouched."""
        return numpy.zeros(self.shape, self.dtype)


#: The skins that are known by their names.
PRESETS = {
    "cody-forearm": Skin(
        name="cody-forearm", rows=16, columns=24, row_pitch_m=0.0108,
        column_pitch_m=2 * math.pi * 0.04604 / 24, taxel_area_m2=0.009 * 0.009,
        wrap_columns=True, contact_threshold=0.01, onset_threshold=0.02),
    "vitac-12x32": Skin(
        name="vitac-12x32", rows=12, columns=32, row_pitch_m=0.002, column_pitch_m=0.002,
        taxel_area_m2=0.002 * 0.002, unit="counts", contact_threshold=20, onset_threshold=40),
    "icub-6x10": Skin(
        name="icub-6x10", rows=6, columns=10, row_pitch_m=0.026, column_pitch_m=0.0065,
        taxel_area_m2=math.pi * 0.002 * 0.002, unit="counts", contact_threshold=4,
        onset_threshold=5),
}


def to_geometry(skin: Skin) -> Any:
    """A skin as a ``tactus.v1.SensorGeometry``."""
    # The enumerations are numbers here, and types in the stubs.
    geometry: Any = common_pb2.SensorGeometry()
    for name, value in (("rows", skin.rows), ("columns", skin.columns),
                        ("axes", skin.axes), ("normal_axis", skin.normal_axis or 0)):
        if not 0 <= value < 2**32:
            raise invalid(f"skin.{name}", value, "0 or more")
    geometry.layout = skin.name
    geometry.rows = skin.rows
    geometry.columns = skin.columns
    geometry.row_pitch_m = skin.row_pitch_m
    geometry.column_pitch_m = skin.column_pitch_m
    geometry.taxel_area_m2 = skin.taxel_area_m2
    geometry.wrap_columns = skin.wrap_columns
    if skin.rows or skin.columns:
        geometry.unit = _UNITS[skin.unit]
    if skin.axes != 1:
        geometry.axes = skin.axes
    if skin.normal_axis is not None:
        geometry.normal_axis = skin.normal_axis
    geometry.signed_values = skin.signed_values
    geometry.contact_threshold = skin.contact_threshold
    geometry.onset_threshold = skin.onset_threshold
    for taxel in skin.masked_taxels:
        if taxel < 0:
            raise invalid("skin.masked_taxels", taxel, "0 or more")
    geometry.masked_taxels.extend(skin.masked_taxels)
    for taxel in skin.auxiliary_taxels:
        if taxel < 0:
            raise invalid("skin.auxiliary_taxels", taxel, "0 or more")
    geometry.auxiliary_taxels.extend(skin.auxiliary_taxels)
    if skin.only_side_neighbours:
        geometry.connectivity = common_pb2.CONNECTIVITY_4
    if skin.light_touch is not None:
        for name in ("window_s", "rows", "columns", "contact_threshold", "onset_threshold"):
            setattr(geometry.light_touch, name, getattr(skin.light_touch, name))
    return geometry


def from_geometry(geometry: Any, **others: Any) -> Skin:
    """The skin that a message describes in full."""
    light = None
    if geometry.HasField("light_touch"):
        light = LightTouch(*(getattr(geometry.light_touch, name) for name in (
            "window_s", "rows", "columns", "contact_threshold", "onset_threshold")))
    return Skin(
        name=geometry.layout, rows=geometry.rows, columns=geometry.columns,
        row_pitch_m=geometry.row_pitch_m, column_pitch_m=geometry.column_pitch_m,
        taxel_area_m2=geometry.taxel_area_m2, wrap_columns=geometry.wrap_columns,
        unit="counts" if geometry.unit == common_pb2.TAXEL_UNIT_COUNTS else "newton",
        contact_threshold=geometry.contact_threshold,
        onset_threshold=geometry.onset_threshold,
        masked_taxels=tuple(geometry.masked_taxels),
        only_side_neighbours=geometry.connectivity == common_pb2.CONNECTIVITY_4,
        light_touch=light, axes=max(1, geometry.axes),
        normal_axis=geometry.normal_axis if geometry.HasField("normal_axis") else None,
        signed_values=geometry.signed_values,
        auxiliary_taxels=tuple(geometry.auxiliary_taxels), **others)
