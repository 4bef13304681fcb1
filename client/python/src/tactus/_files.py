"""Recording: the trials of a file."""

from __future__ import annotations

import os
import pathlib
from typing import Any, Dict, Iterator, List, Mapping, Optional, Sequence, Tuple, Union, overload

import numpy
from google.protobuf import json_format

from tactus._errors import Error
from tactus._skin import PRESETS, Skin, from_geometry, to_geometry
from tactus._trials import Touch, Trial
from tactus.v1 import common_pb2

_TEXTS = ("label", "condition", "object", "material", "source")
_NUMBERS = ("stiffness", "velocity")
_HEADER = "time,force,area,motion"


class Recording(Sequence[Trial]):
    """The trials of a file, or of a folder of .npz and .csv files.

    Trial files (.h5) need the package h5py. An .npz or .csv file holds one
    trial::

        recording = tactus.Recording("mine.h5")
        print(len(recording), recording[0].taxels.shape)
        recording.to_pandas().groupby("label").size()

    ``skin`` describes trials of files that name a layout and no skin.
    """

    def __init__(self, path: Union[str, "os.PathLike[str]"], skin: Optional[Skin] = None) -> None:
        self.path = pathlib.Path(path)
        self._trials = tuple(_read(self.path, skin))

    def __len__(self) -> int:
        return len(self._trials)

    @overload
    def __getitem__(self, index: int) -> Trial: ...

    @overload
    def __getitem__(self, index: slice) -> Tuple[Trial, ...]: ...

    def __getitem__(self, index: Union[int, slice]) -> Union[Trial, Tuple[Trial, ...]]:
        return self._trials[index]

    def to_pandas(self) -> Any:
        """A pandas.DataFrame with a row for each trial."""
        import pandas

        return pandas.DataFrame([{
            "id": trial.id, "label": trial.label, "condition": trial.condition,
            "object": trial.object, "material": trial.material, "stiffness": trial.stiffness,
            "velocity": trial.velocity, "frames": trial.frames, "rate_hz": trial.rate_hz,
            "seconds": float(trial.time[-1] - trial.time[0]), "source": trial.source,
            "skin": trial.skin.name if trial.skin else "",
        } for trial in self._trials])

    def __repr__(self) -> str:
        return f"<tactus.Recording {self.path}, {len(self)} trials>"


def write_trials(path: Union[str, "os.PathLike[str]"], trials: Sequence[Trial]) -> None:
    """Writes a trial file (.h5), as docs/formats.md describes it. Needs h5py."""
    import h5py

    with h5py.File(path, "w") as file:
        file.attrs["format"] = "tactus-trials"
        file.attrs["version"] = 1
        for i, trial in enumerate(trials):
            group = file.create_group(f"trials/{trial.id or f'{i:06}'}")
            group["time"] = numpy.asarray(trial.time, float)
            for name, values in (("signals", trial.signals), ("pose", trial.poses),
                                 ("object_motion", trial.object_motion)):
                if values is not None:
                    group[name] = numpy.asarray(values, float)
            if trial.taxels is not None and trial.skin is not None:
                taxels = group.create_dataset("taxels", data=trial.taxels, compression="gzip",
                                              compression_opts=1, shuffle=True)
                if trial.skin.dtype != "float32":
                    taxels.attrs["scale"] = float(trial.skin.scale)
                whole = trial.skin.resolved()
                group.attrs["layout"] = whole.name
                group.attrs["skin"] = json_format.MessageToJson(
                    to_geometry(whole), preserving_proto_field_name=True, indent=0)
            for name in _TEXTS:
                # h5py takes no texts of numpy, which labels often are.
                group.attrs[name] = str(getattr(trial, name))
            for name in _NUMBERS:
                group.attrs[name] = getattr(trial, name)
            group.attrs["sample_rate_hz"] = float(trial.rate_hz)
            group.attrs["unit"] = trial.unit
            for number, touch in enumerate(trial.touches):
                _write_touch(group.create_group(f"touches/{number:02}"), touch)


def _write_touch(group: Any, touch: Touch) -> None:
    for name in ("begin_s", "end_s", "label", "row", "column", "object", "material",
                 "stiffness"):
        value = getattr(touch, name)
        if value is not None:
            group.attrs[name] = value
    if touch.object_motion is not None:
        group["object_motion"] = touch.object_motion


def _read(path: pathlib.Path, skin: Optional[Skin]) -> Iterator[Trial]:
    try:
        if path.is_dir():
            found = sorted(p for p in path.iterdir() if p.suffix in (".npz", ".csv"))
            if not found:
                raise _bad(path, "holds no .npz or .csv file")
            for inner in found:
                yield from _read(inner, skin)
        elif path.suffix == ".csv":
            yield _read_csv(path)
        elif path.suffix == ".npz":
            yield _read_npz(path, skin)
        elif path.suffix in (".h5", ".hdf5"):
            yield from _read_h5(path, skin)
        else:
            raise _bad(path, "its name must end in .h5, .npz or .csv")
    except OSError as error:
        raise Error(f"{path}: {error.strerror or error}", reason="IO", code="UNAVAILABLE",
                    metadata={"path": str(path)}) from error


def _bad(path: object, what: str) -> Error:
    return Error(f"{path}: {what}", reason="TRIAL_FILE_INVALID", metadata={"path": str(path)})


def _text(value: Any) -> str:
    if isinstance(value, numpy.ndarray):
        value = value.item()
    if isinstance(value, bytes):
        value = value.decode("utf-8")
    return str(value).rstrip("\0 ")


def _skin_of(values: Mapping[str, Any], taxels: Any, scale: float, rate_hz: float,
             skin: Optional[Skin]) -> Skin:
    """The skin of a trial, from its own words, or from its layout's name."""
    others = {"dtype": taxels.dtype.name, "scale": scale, "rate_hz": rate_hz,
              "with_poses": "pose" in values}
    if "skin" in values and _text(values["skin"]):
        geometry = json_format.Parse(_text(values["skin"]), common_pb2.SensorGeometry())
        found = from_geometry(geometry, **others)
    elif skin is not None:
        found = skin.replace(**others)
    else:
        found = Skin(name=_text(values.get("layout", "")), **others)
        if found.name not in PRESETS:
            raise ValueError(f"the layout {found.name!r} is no preset; give its skin")
    return found.resolved()


def _trial_of(values: Mapping[str, Any], name: str, skin: Optional[Skin],
              touches: Tuple[Touch, ...]) -> Trial:
    rate_hz = float(values.get("sample_rate_hz", 100.0))
    taxels = values.get("taxels")
    found = None
    if taxels is not None:
        found = _skin_of(values, taxels, float(values.get("taxel_scale", 1.0)), rate_hz, skin)

    def array(key: str) -> Any:
        return None if key not in values else numpy.asarray(values[key], float)

    texts = {key: _text(values.get(key, "")) for key in _TEXTS}
    numbers = {key: float(values.get(key, 0.0)) for key in _NUMBERS}
    time = array("time")
    if time is None:
        raise ValueError("time is missing")
    return Trial(taxels=taxels, skin=found, id=name, time=time.reshape(-1),
                 signals=array("signals"), poses=array("pose"),
                 object_motion=array("object_motion"), rate_hz=rate_hz,
                 unit=found.unit if found else _text(values.get("unit", "newton")),
                 touches=touches, **texts, **numbers)  # type: ignore[arg-type]


def _touch_of(values: Mapping[str, Any]) -> Touch:
    def number(key: str) -> Optional[float]:
        return float(values[key]) if key in values else None

    motion = values.get("object_motion")
    return Touch(number("begin_s") or 0.0, number("end_s") or 0.0,
                 _text(values.get("label", "")), number("row"), number("column"),
                 _text(values.get("object", "")), _text(values.get("material", "")),
                 number("stiffness") or 0.0,
                 None if motion is None else numpy.asarray(motion, float))


def _read_h5(path: pathlib.Path, skin: Optional[Skin]) -> List[Trial]:
    import h5py

    trials = []
    with h5py.File(path, "r") as file:
        if _text(file.attrs.get("format", "")) != "tactus-trials":
            raise _bad(path, "is no trial file: it has no attribute format of tactus-trials")
        if int(file.attrs.get("version", 0)) != 1:
            raise _bad(path, f"has version {file.attrs.get('version')}; it must be 1")
        for name in sorted(file["trials"]):
            group = file["trials"][name]
            values: Dict[str, Any] = dict(group.attrs)
            for key in ("time", "signals", "taxels", "pose", "object_motion"):
                if key in group:
                    values[key] = group[key][()]
            if "taxels" in group:
                values["taxel_scale"] = float(group["taxels"].attrs.get("scale", 1.0))
            touches = []
            for number in sorted(group.get("touches", {})):
                touch = group["touches"][number]
                touches.append(_touch_of({**touch.attrs, **{
                    key: touch[key][()] for key in touch}}))
            trials.append(_named(path, name, values, skin, tuple(touches)))
    return trials


def _named(path: pathlib.Path, name: str, values: Mapping[str, Any], skin: Optional[Skin],
           touches: Tuple[Touch, ...]) -> Trial:
    try:
        return _trial_of(values, name, skin, touches)
    except (ValueError, TypeError, Error, json_format.ParseError) as error:
        raise _bad(path, f"trial {name}: {getattr(error, 'message', error)}") from error


def _read_npz(path: pathlib.Path, skin: Optional[Skin]) -> Trial:
    try:
        # A pickle can run any program when it is read.
        with numpy.load(path, allow_pickle=False) as arrays:
            values = {key: arrays[key] for key in arrays.files}
    except ValueError as error:
        raise _bad(path, str(error)) from error
    touches: List[Touch] = []
    while f"touches/{len(touches):02}/begin_s" in values:
        prefix = f"touches/{len(touches):02}/"
        touches.append(_touch_of({key[len(prefix):]: value for key, value in values.items()
                                  if key.startswith(prefix)}))
    return _named(path, path.stem, values, skin, tuple(touches))


def _read_csv(path: pathlib.Path) -> Trial:
    values: Dict[str, Any] = {}
    lines = path.read_text(encoding="utf-8").splitlines()
    at = 0
    while at < len(lines) and lines[at].startswith("#"):
        key, _, value = lines[at][1:].strip().partition("=")
        values[key] = value
        at += 1
    if at == len(lines) or lines[at] != _HEADER:
        raise _bad(path, f"line {at + 1} must be {_HEADER}")
    try:
        table = numpy.array([line.split(",") for line in lines[at + 1:]], float)
        if table.ndim != 2 or table.shape[1] != 4 or len(table) < 2:
            raise ValueError("it must have two rows of four numbers, or more")
    except ValueError as error:
        raise _bad(path, str(error)) from error
    values["time"] = table[:, 0]
    values["signals"] = table[:, 1:]
    values.setdefault("sample_rate_hz",
                      (len(table) - 1) / max(table[-1, 0] - table[0, 0], 1e-9))
    return _named(path, path.stem, values, None, ())
