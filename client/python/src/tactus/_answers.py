"""What is known of a skin's contacts after a frame, by names.

What was not measured is None, never zero.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from operator import attrgetter
from typing import Any, Dict, Mapping, Optional, Tuple

import numpy
import numpy.typing

from tactus._errors import Error
from tactus._frames import Message
from tactus._lazy import Lazy
from tactus._skin import Skin

STATES = {1: "touching", 2: "lost", 3: "merged", 4: "released"}
EVENTS = {1: "touched", 2: "released", 3: "decided", 4: "changed", 5: "unknown",
          6: "merged", 7: "split", 8: "moved over skin"}
_DECISIONS = (3, 4)


@dataclass(frozen=True)
class Point:
    """A place or a direction; metres, or of unit length."""

    x: float
    y: float
    z: float


@dataclass(frozen=True)
class Spot:
    """A place on the skin and the outward unit normal there: in the frame of
    the skin's link, and in the world if frames have poses. Metres."""

    link: Point
    link_normal: Point
    world: Optional[Point]
    world_normal: Optional[Point]


@dataclass(frozen=True)
class DecidedValue:
    """The value whose probability stayed high for long enough."""

    value: str
    #: The frame at which the question was decided first, and the time from
    #: onset to it.
    sequence: int
    since_onset_ns: int
    #: How often the value has changed since then, and when it did last; 0 if it
    #: has not.
    changes: int
    changed_sequence: int
    changed_since_onset_ns: int
    #: The question is about a property that stays, and yet its value changed.
    revised: bool


@dataclass(frozen=True)
class QuestionAnswer(Lazy):
    """What is known of one of the model's questions."""

    question: str
    #: Probability per value; they sum to 1.
    values: Mapping[str, float]
    decided: Optional[DecidedValue]

    # A mapping has no hash.
    def __hash__(self) -> int:
        return hash(self.question)


@dataclass(frozen=True)
class TouchedObject:
    """Estimates of the object that is touched: means and deviations."""

    #: log10 of its stiffness in N/m.
    log10_stiffness: float
    log10_stiffness_deviation: float
    #: Metres that it has moved since onset.
    moved_m: float
    moved_deviation_m: float


@dataclass(frozen=True)
class Patch(Lazy):
    """Where a contact is on the skin, and how hard it presses there."""

    #: Sum and largest of the region's loads, in the skin's unit.
    force: float
    max_force: float
    area_taxels: int
    #: Square metres.
    area_m2: float
    #: The region's centroid by fractional row and column, and as a place.
    centroid_row: float
    centroid_column: float
    centroid: Spot
    #: The centroid by load; None if no taxel reads a load at this moment.
    centre_of_pressure: Optional[Spot]
    #: With ``with_taxels``: row-major indices, rising.
    taxels: Tuple[int, ...]


@dataclass(frozen=True)
class Contact(Lazy):
    """One contact on the skin after a frame."""

    #: Counts the contacts of a stream from 1.
    id: int
    #: "touching"; "lost": it touches no taxel for the moment; "merged": its
    #: region has joined that of ``merged_into``; "released".
    state: str
    #: The frame at which it began, and the time since then.
    onset_sequence: int
    since_onset_ns: int
    #: None unless it touches the skin.
    patch: Optional[Patch]
    #: Metres that it has moved since its onset; None after its end.
    motion_m: Optional[float]
    #: Probability per class of the model; they sum to 1.
    classes: Mapping[str, float]
    #: Per question of the model.
    answers: Mapping[str, QuestionAnswer]
    #: Probability that the model has learned from nothing like this contact.
    unknown: float
    #: None if the model estimates none.
    object: Optional[TouchedObject]
    #: The contact of whose region it was a part, and the one that it is merged
    #: into; 0 if none.
    parent: int
    merged_into: int

    def __hash__(self) -> int:
        return hash((self.id, self.since_onset_ns))

    @property
    def best(self) -> str:
        """The most probable class."""
        return max(self.classes, key=self.classes.__getitem__)

    def probability(self, question: str, value: str) -> float:
        """Probability of a value of a question; 0 if the model has none such."""
        names = self.__dict__.get("_names")
        if names is not None:
            # Robots ask for one number of each answer.
            place = names.places.get((question, value))
            if place is None:
                return 0.0
            try:
                found: float = self.__dict__["_message"].answers[place[0]].probability[place[1]]
                return found
            except IndexError:
                pass  # A broken answer; what follows says so.
        answer = self.answers.get(question)
        return 0.0 if answer is None else answer.values.get(value, 0.0)

    def decided(self, question: str) -> Optional[str]:
        """The decided value of a question; None while there is none."""
        answer = self.answers.get(question)
        if answer is None or answer.decided is None:
            return None
        return answer.decided.value

    def _repr_html_(self) -> str:
        from tactus._svg import contact_html

        return contact_html(self)


@dataclass(frozen=True)
class Event:
    """What happened to a contact."""

    #: "touched", "released", "decided", "changed", "unknown", "merged", "split"
    #: or "moved over skin".
    kind: str
    contact: int
    #: The frame at which it happened, and the contact's time since onset then.
    sequence: int
    capture_time_ns: int
    since_onset_ns: int
    #: Of "decided" and "changed"; else empty.
    question: str
    value: str
    #: Of "merged" and "split"; else 0.
    other_contact: int

    def __str__(self) -> str:
        text = f"{self.since_onset_ns // 10**6} ms: contact {self.contact} {self.kind}"
        if self.question:
            text += f" {self.question}: {self.value}"
        if self.other_contact:
            text += f" contact {self.other_contact}"
        return text


@dataclass(frozen=True)
class Answer(Lazy):
    """The answer to a frame."""

    #: The frame's number and time.
    sequence: int
    capture_time_ns: int
    #: The contacts that there are, and those that ended with this frame, the
    #: largest first. In a final answer, those that the end of the trial ended.
    contacts: Tuple[Contact, ...]
    #: What happened at this frame.
    events: Tuple[Event, ...]
    #: Regions of touched taxels, also those that are no contact.
    regions: int
    #: Frames of this trial that were lost so far.
    frames_missing: int
    #: Interim answers of this stream that a newer one replaced so far.
    superseded: int
    #: The last answer of a trial.
    is_final: bool
    #: The frame, [rows, columns(, axes)] as it was sent; None if it is not
    #: known any more.
    frame: Optional["numpy.typing.NDArray[Any]"] = field(compare=False, repr=False)
    #: The skin in use.
    skin: Skin = field(compare=False, repr=False)

    def __hash__(self) -> int:
        return hash((self.sequence, self.is_final))

    @property
    def main(self) -> Optional[Contact]:
        """The contact that a robot reads if it wants one; None if there is none."""
        values = self.__dict__
        contacts = values.get("contacts")
        if contacts is None:
            contacts = values["contacts"] = _contacts(values)
        return contacts[0] if contacts else None

    def plot(self, axes: Any = None) -> Any:
        """Draws the skin and the probabilities with matplotlib; returns the axes."""
        from tactus._plot import plot_answer

        return plot_answer(self, axes)

    def _repr_html_(self) -> str:
        from tactus._svg import answer_html

        return answer_html(self)


@dataclass(frozen=True)
class Notice:
    """News about a stream, not about a contact."""

    #: "draining", "model superseded", "rate differs" or "skin differs".
    kind: str
    #: For people.
    text: str


@dataclass(frozen=True)
class QuestionInfo:
    """A question that a model answers."""

    name: str
    #: True if the answer may change during a contact.
    is_state: bool
    values: Tuple[str, ...]


@dataclass(frozen=True)
class StreamInfo:
    """What answers a stream."""

    #: "models/M/versions/V".
    model_version: str
    #: SHA-256 of the model's file, hexadecimal.
    model_sha256: str
    classes: Tuple[str, ...]
    questions: Tuple[QuestionInfo, ...]
    max_contacts: int
    stream_id: str
    server_version: str


class Names:
    """What the indices in answers of a stream stand for."""

    def __init__(self, info: StreamInfo, skin: Skin) -> None:
        self.info = info
        self.skin = skin
        self.classes = info.classes
        self.questions = tuple((question.name, question.values) for question in info.questions)
        self.places = {(question.name, value): (q, v) for q, question in enumerate(info.questions)
                       for v, value in enumerate(question.values)}


def info_of(started: Any) -> StreamInfo:
    """The StreamInfo of a ``tactus.v1.StreamStarted``."""
    return StreamInfo(
        model_version=started.model_version, model_sha256=started.bundle_sha256,
        classes=tuple(started.class_names),
        questions=tuple(QuestionInfo(q.name, q.kind == 2, tuple(q.values))
                        for q in started.questions),
        max_contacts=started.limits.max_contacts, stream_id=started.stream_id,
        server_version=started.server.version)


def answer_of(message: Any, names: Names, request: Optional[Message] = None) -> Answer:
    """An Answer that reads ``message``, a ``tactus.v1.Answer``, when asked;
    ``request`` has its frame."""
    answer: Answer = object.__new__(Answer)
    answer.__dict__.update(_message=message, _names=names, _request=request)
    return answer


def contact_of(message: Any, names: Names) -> Contact:
    """A Contact that reads a ``tactus.v1.Contact`` when asked."""
    contact: Contact = object.__new__(Contact)
    values = contact.__dict__
    values["_message"] = message
    values["_names"] = names
    return contact


_Values = Dict[str, Any]


def _point(vector: Any) -> Point:
    return Point(vector.x, vector.y, vector.z)


def _spot(place: Any) -> Spot:
    world = place.HasField("world")
    return Spot(_point(place.link), _point(place.link_normal),
                _point(place.world) if world else None,
                _point(place.world_normal) if world else None)


def _patch(values: _Values) -> Optional[Patch]:
    message = values["_message"]
    if not message.HasField("patch"):
        return None
    patch: Patch = object.__new__(Patch)
    patch.__dict__.update(_message=message.patch)
    return patch


def _centre(values: _Values) -> Optional[Spot]:
    patch = values["_message"]
    return _spot(patch.centre_of_pressure) if patch.HasField("centre_of_pressure") else None


def _motion(values: _Values) -> Optional[float]:
    contact = values["_message"]
    return contact.motion_m if contact.HasField("motion_m") else None


def _questions(values: _Values) -> Dict[str, QuestionAnswer]:
    answers = values["_message"].answers
    questions = values["_names"].questions
    if len(answers) != len(questions):
        raise _broken("contact.answers", len(answers), len(questions))
    made = {}
    for named, message in zip(questions, answers):
        answer: QuestionAnswer = object.__new__(QuestionAnswer)
        answer.__dict__.update(question=named[0], _message=message, _names=named[1])
        made[named[0]] = answer
    return made


def _probabilities(message: Any, names: Tuple[str, ...], what: str) -> Dict[str, float]:
    probability = message.probability
    if len(probability) != len(names):
        raise _broken(what, len(probability), len(names))
    return dict(zip(names, probability))


def _decided(values: _Values) -> Optional[DecidedValue]:
    answer = values["_message"]
    if not answer.HasField("decision"):
        return None
    made = answer.decision
    return DecidedValue(
        value=values["_names"][made.value], sequence=made.sequence,
        since_onset_ns=made.time_since_onset_ns, changes=made.changes,
        changed_sequence=made.changed_sequence,
        changed_since_onset_ns=made.changed_time_since_onset_ns, revised=made.revised)


def _object(values: _Values) -> Optional[TouchedObject]:
    contact = values["_message"]
    if not contact.HasField("object"):
        return None
    found = contact.object
    return TouchedObject(found.log10_stiffness, found.log10_stiffness_deviation,
                         found.moved_m, found.moved_deviation_m)


def _contacts(values: _Values) -> Tuple[Contact, ...]:
    names = values["_names"]
    return tuple([contact_of(contact, names) for contact in values["_message"].contacts])


def _events(values: _Values) -> Tuple[Event, ...]:
    answer = values["_message"]
    if not answer.events:
        return ()
    since = {contact.id: contact.time_since_onset_ns for contact in answer.contacts}
    made = []
    for event in answer.events:
        # A kind of a newer contract has no name here.
        kind = EVENTS.get(event.kind)
        if kind is None:
            continue
        question = value = ""
        if event.kind in _DECISIONS:
            question, values_ = values["_names"].questions[event.question]
            value = values_[event.value]
        made.append(Event(kind, event.contact_id, answer.sequence, answer.capture_time_ns,
                          since.get(event.contact_id, 0), question, value, event.other_id))
    return tuple(made)


def _frame(values: _Values) -> Any:
    """A view into the request, which cannot be written to."""
    request = values["_request"]
    if request is None:
        return None
    skin = values["_names"].skin
    count = skin.rows * skin.columns * skin.axes
    dtype = numpy.dtype(skin.dtype)
    before = values["_message"].sequence - request.first_sequence
    return numpy.frombuffer(request.request, dtype, count,
                            request.offset + before * count * dtype.itemsize).reshape(skin.shape)


def _broken(what: str, size: int, expected: int) -> Error:
    return Error(f"size of {what} is {size}; it must be {expected}",
                 reason="INVALID_RESPONSE", code="INTERNAL")


def _plain(**fields_: str) -> Dict[str, Any]:
    """Decoders that read a field of the message as it is."""
    made: Dict[str, Any] = {}
    for name, field_of_message in fields_.items():
        get = attrgetter(field_of_message)
        made[name] = lambda values, get=get: get(values["_message"])
    return made


Patch._decoders = dict(
    _plain(force="force", max_force="max_force", area_taxels="area_taxels", area_m2="area_m2",
           centroid_row="centroid_row", centroid_column="centroid_column"),
    centroid=lambda values: _spot(values["_message"].centroid),
    centre_of_pressure=_centre,
    taxels=lambda values: tuple(values["_message"].taxels))

QuestionAnswer._decoders = dict(
    values=lambda values: _probabilities(values["_message"], values["_names"],
                                         "contact.answers.probability"),
    decided=_decided)

Contact._decoders = dict(
    _plain(id="id", onset_sequence="onset_sequence", since_onset_ns="time_since_onset_ns",
           unknown="unknown", parent="parent_id", merged_into="merged_into"),
    state=lambda values: STATES.get(values["_message"].state, "touching"),
    patch=_patch,
    motion_m=_motion,
    classes=lambda values: _probabilities(values["_message"], values["_names"].classes,
                                          "contact.probability"),
    answers=_questions,
    object=_object)

Answer._decoders = dict(
    _plain(sequence="sequence", capture_time_ns="capture_time_ns", regions="region_count",
           frames_missing="frames_missing", superseded="superseded", is_final="is_final"),
    contacts=_contacts,
    events=_events,
    frame=_frame,
    skin=lambda values: values["_names"].skin)
