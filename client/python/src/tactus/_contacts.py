"""The contact log: what robots touched last, and labels for it."""

from __future__ import annotations

import datetime
from dataclasses import dataclass, field
from typing import Any, Mapping, Optional, Tuple, Union

import numpy
import numpy.typing

from tactus._answers import Answer, Names, StreamInfo, answer_of, info_of
from tactus._names import time_of
from tactus._skin import Skin, from_geometry


@dataclass(frozen=True)
class LoggedAnswer:
    """What was answered to a question when the contact ended."""

    question: str
    #: The most probable value, or the decided one.
    value: str
    probability: float
    decided: bool
    revised: bool


@dataclass(frozen=True)
class LoggedContact:
    """A contact that the server keeps."""

    #: "contacts/C".
    name: str
    #: What the robot calls itself.
    robot: str
    model_version: str
    layout: str
    #: Its onset, by the server's clock.
    began: datetime.datetime
    duration_s: float
    #: The class that is most probable at its end, and its probability.
    label: str
    confidence: float
    unknown: float
    answers: Mapping[str, LoggedAnswer]
    #: The largest taxel, in the skin's unit.
    max_force: float
    #: The kept frames give the same answers again, bit for bit.
    exact: bool
    #: The label that was given to it last, and by whom; None if none was.
    given_label: Optional[str]
    given_by: Optional[str]
    #: Loads of the frame with the largest load, [rows, columns]; None unless
    #: pictures were asked for.
    picture: Optional["numpy.typing.NDArray[numpy.float32]"] = field(compare=False)

    # A mapping has no hash.
    def __hash__(self) -> int:
        return hash(self.name)

    def __str__(self) -> str:
        return self.name


@dataclass(frozen=True)
class ContactLabel:
    """A label for a contact, and what is known of its object."""

    label: str
    object: str = ""
    condition: str = ""
    material: str = ""
    #: A program proposed the label, and a person let it stand.
    prefilled: bool = False


@dataclass(frozen=True)
class Replay:
    """The frames of a logged contact, answered once more."""

    contact: LoggedContact
    info: StreamInfo
    skin: Skin
    #: Of each frame, with its events.
    answers: Tuple[Answer, ...]
    #: [T, rows, columns(, 3)] in the skin's unit; None if left out.
    loads: Optional["numpy.typing.NDArray[numpy.float32]"]
    #: The answers are those of before, bit for bit.
    same_answers: bool


Labels = Mapping[Union[str, LoggedContact], Union[str, ContactLabel]]


def logged_of(c: Any) -> LoggedContact:
    given = c.HasField("given")
    picture = None
    if c.HasField("picture"):
        shape = (c.picture.rows, c.picture.columns)
        picture = (numpy.frombuffer(c.picture.loads, numpy.uint8).reshape(shape)
                   * numpy.float32(c.picture.most / 255))
    return LoggedContact(
        c.name, c.robot, c.model_version, c.layout, time_of(c.begin_time_ms),
        c.duration_ns / 1e9, c.label, c.confidence, c.unknown,
        {a.question: LoggedAnswer(a.question, a.value, a.probability, a.decided, a.revised)
         for a in c.answers}, c.max_force, c.exact, c.given.label if given else None,
        c.given.labelling.by if given else None, picture)


def replay_of(r: Any) -> Replay:
    skin = from_geometry(r.started.geometry, dtype="float32")
    info = info_of(r.started)
    names = Names(info, skin)
    loads = None
    if r.frames and r.frames[0].taxels:
        loads = numpy.stack([numpy.frombuffer(frame.taxels, "<f4").reshape(skin.shape)
                             for frame in r.frames])
    return Replay(logged_of(r.contact), info, skin,
                  tuple(answer_of(frame.answer, names) for frame in r.frames), loads,
                  r.same_answers)
