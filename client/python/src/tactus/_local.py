"""Classifier: answers in this process, without a server.

It runs the code that a server runs, so its answers have the same bits. The
module ``tactus._native`` holds that code; a wheel has it unless it was built
with ``client/python/build.sh --pure``.
"""

from __future__ import annotations

import os
from typing import Any, Callable, List, Optional, Tuple, Union

from tactus._calibration import Calibration
from tactus._errors import Error, from_message, invalid, stream_finished
from tactus._frames import END_OF_TRIAL, Message
from tactus._answers import Answer
from tactus._link import State
from tactus._options import StreamOptions
from tactus._skin import Skin, from_geometry
from tactus._stream import Stream, StreamCore
from tactus._trials import Trial
from tactus.v1 import common_pb2, contact_pb2


def native() -> Any:
    """The compiled module."""
    try:
        from tactus import _native as module
    except ImportError as error:
        raise Error("this installation of tactus cannot classify and train without a server",
                    code="UNIMPLEMENTED",
                    advice="install a wheel of client/python/build.sh without --pure, or use a "
                           "server: tactus.Client, TouchClassifier(address=...)") from error
    return module


def made(pair: Any) -> Any:
    """What a function of the module made; raises its error."""
    result, failure = pair
    if failure is not None:
        raise from_message(common_pb2.Status.FromString(failure))
    return result


class _Progress:
    """What a StreamHistory knows that its stream asks for."""

    replayed_frames = 0
    ending = False

    def __init__(self) -> None:
        self.trial_frames = 0


class LocalLink:
    """Stands in for a Link: frames are answered when send returns."""

    resumed = 0
    without_beginning = 0

    def __init__(self, model: Any, config: Any,
                 deliver: Callable[[Any, Optional[Message]], None],
                 notice: Callable[[Any], None]) -> None:
        self._session = made(native().open(model, config.SerializeToString()))
        self._deliver = deliver
        self._notice = notice
        self.started = contact_pb2.StreamStarted.FromString(self._session.started())
        self.history = _Progress()
        self.state = State.CONNECTED
        self.error: Optional[Error] = None

    def send(self, message: Message) -> None:
        self._exchange(message.request, message)
        self.history.trial_frames += message.frames

    def end_trial(self) -> None:
        self._exchange(END_OF_TRIAL, None)
        self.history.trial_frames = 0

    def close(self) -> None:
        self.state = State.ENDED

    def cancel(self) -> None:
        self.error = Error("the stream was cancelled", reason="CANCELLED", code="CANCELLED")
        self.state = State.ENDED

    def wait(self, seconds: float, wanted: Callable[[], bool]) -> None:
        """All answers have come."""

    def end_error(self) -> Error:
        return self.error or stream_finished()

    def _exchange(self, request: bytes, message: Optional[Message]) -> None:
        if self.state is State.ENDED:
            raise self.end_error()
        failure, responses = self._session.exchange(request)
        for payload in responses:
            response = contact_pb2.ClassifyContactResponse.FromString(payload)
            if response.HasField("answer"):
                self._deliver(response.answer, message)
            else:
                self._notice(response.notice)
        if failure is not None:
            self.error = from_message(common_pb2.Status.FromString(failure))
            self.state = State.ENDED
            raise self.error


class Classifier:
    """A model in this process::

        classifier = tactus.Classifier("no-poses.tactus")
        with classifier.stream(skin) as stream:
            for answer in stream.push(frame):
                ...

    ``path`` is a model's file (trainctl fit, Client.export_model). It is checked
    that it computes here what it computed where it was made. IO,
    BUNDLE_CORRUPT, BUNDLE_VERSION, INVALID_MODEL.

    Its streams have the methods and the answers, bit for bit, of those of
    ``Client``. It has no threads. Any thread may open streams; a stream belongs
    to one. While a frame is computed, other threads of Python run.
    """

    def __init__(self, path: Union[str, "os.PathLike[str]"]) -> None:
        self._model = made(native().load(os.fspath(path)))

    @classmethod
    def decode(cls, bundle: bytes, path: str = "") -> "Classifier":
        """A model whose file is in memory. BUNDLE_CORRUPT, BUNDLE_VERSION,
        INVALID_MODEL."""
        classifier = cls.__new__(cls)
        classifier._model = made(native().decode(bundle, path))
        return classifier

    @property
    def path(self) -> str:
        return str(self._model.path)

    @property
    def sha256(self) -> str:
        """SHA-256 of the model's file, hexadecimal."""
        return str(self._model.sha256)

    @property
    def classes(self) -> Tuple[str, ...]:
        """The model's classes, in its order."""
        return tuple(self._model.classes)

    @property
    def note(self) -> str:
        """What was noted of the model when it was made."""
        return str(self._model.note)

    @property
    def skin(self) -> Optional[Skin]:
        """The skin of its training data, in its unit as float32; None for a model
        of any skin."""
        geometry: Any = common_pb2.SensorGeometry.FromString(self._model.geometry)
        if not geometry.layout:
            return None
        return from_geometry(geometry, dtype="float32", rate_hz=self._model.rate_hz)

    def stream(self, skin: Skin, *, calibration: Optional[Calibration] = None, tare: int = 0,
               drift_s: float = 0.0, **options: Any) -> Stream:
        """As :meth:`tactus.Client.stream`; ``model`` is the file."""
        chosen = StreamOptions(**options)
        if chosen.model:
            raise invalid("model", chosen.model, "empty: the file that was loaded is the model")
        return Stream(StreamCore(
            lambda config, lockstep, deliver, notice: LocalLink(
                self._model, config, deliver, notice),
            skin, chosen, calibration, tare, drift_s))

    open = stream

    def classify(self, trials: List[Trial], **options: Any) -> List[Answer]:
        """The final answer to each trial."""
        finals: List[Answer] = []
        for trial in trials:
            if trial.taxels is None or trial.skin is None:
                raise invalid("taxels of a trial", "missing", "given")
            skin = trial.skin.replace(with_poses=trial.poses is not None)
            with self.stream(skin, cadence="events", frames_per_message=64,
                             **options) as stream:
                stream.push_many(trial.taxels, poses=trial.poses)
                finals.append(stream.end_trial())
        return finals

    def __repr__(self) -> str:
        return f"<tactus.Classifier of {self.path}>"
