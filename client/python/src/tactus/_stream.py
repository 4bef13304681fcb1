"""Stream: frames in, answers out."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from types import TracebackType
from typing import Any, Callable, Deque, List, Optional, Sequence, Tuple, Type

import grpc
import numpy
import numpy.typing

from tactus._answers import Answer, Event, Names, Notice, StreamInfo, info_of
from tactus._calibration import Calibration, Loads
from tactus._errors import Error, FrameError
from tactus._frames import FrameWriter, Message, check_frames_per_message
from tactus._link import Link, State, Timeouts
from tactus._notices import notice_of
from tactus._options import StreamOptions, to_config
from tactus._skin import Skin, from_geometry

# Beyond these, the oldest are dropped.
_MOST_ANSWERS = 16_384
_MOST_EVENTS = 16_384

Frame = "numpy.typing.NDArray[Any]"


@dataclass(frozen=True)
class StreamStatistics:
    """What has happened on a stream so far."""

    frames: int
    #: Connections after the first, the frames that were sent again, and how
    #: often the beginning of a trial or contact was no longer kept.
    resumed: int
    frames_sent_again: int
    without_beginning: int
    #: Answers that nobody took: the oldest are dropped beyond 16,384.
    answers_dropped: int


@dataclass(frozen=True)
class Connection:
    """What a client's streams have in common."""

    channel: grpc.Channel
    metadata: Tuple[Tuple[str, str], ...]
    timeouts: Timeouts
    replay_bytes: int
    direct: Optional[bool] = None

    def link(self, client_id: str, config: Any, lockstep: bool,
             deliver: Callable[[Any, Optional[Message]], None], notice: Callable[[Any], None],
             changed: Callable[[], None]) -> Link:
        """A link of a stream."""
        metadata = self.metadata
        if client_id and client_id.isascii() and client_id.isprintable():
            # By this, a proxy can send all streams of a robot to one server.
            metadata += (("x-robot-id", client_id),)
        return Link(self.channel, config, metadata, timeouts=self.timeouts,
                    replay_bytes=self.replay_bytes, lockstep=lockstep, deliver=deliver,
                    notice=notice, changed=changed, direct=self.direct)


class StreamCore:
    """What Stream and AsyncStream share. Not for users."""

    def __init__(self, make_link: Callable[..., Any], skin: Skin, options: StreamOptions,
                 calibration: Optional[Calibration], tare: int, drift_s: float,
                 in_loop: bool = False) -> None:
        self.loads: Optional[Loads] = None
        if calibration is not None or tare:
            self.loads = Loads(skin, calibration, tare, drift_s)
            skin = self.loads.skin
        config = to_config(skin, options)
        check_frames_per_message(options.frames_per_message)
        self.lockstep = options.wait and options.cadence == "interval" and not in_loop
        self.answers: Deque[Answer] = deque(maxlen=_MOST_ANSWERS)
        self.dropped = 0
        self.events: Deque[Event] = deque(maxlen=_MOST_EVENTS)
        self.notices: Deque[Notice] = deque(maxlen=64)
        self.final: Optional[Answer] = None
        self.frames = 0
        self._names: Optional[Names] = None
        # A Link, or what stands in for one.
        self.link: Any = make_link(config, self.lockstep, self._deliver, self._notice)
        started = self.link.started
        self.info: StreamInfo = info_of(started)
        self.skin = from_geometry(started.geometry, dtype=skin.dtype, scale=skin.scale,
                                  rate_hz=skin.rate_hz, with_poses=skin.with_poses)
        self.trained_skin = (from_geometry(started.trained_geometry)
                             if started.HasField("trained_geometry") else None)
        self.names = self._names = Names(self.info, self.skin)
        self.writer = FrameWriter(self.skin, options.frames_per_message)

    def pack(self, frame: Any, capture_time_ns: Optional[int], missing_before: int,
             pose: Optional[Sequence[float]]) -> Tuple[Message, ...]:
        """Raises what the stream ended with."""
        if self.link.state is State.ENDED:
            raise self.link.end_error()
        if self.loads is not None:
            frame = self.loads.of(frame)
            if frame is None:
                return ()
        messages = self.writer.add(frame, capture_time_ns, missing_before, pose)
        self.frames += 1
        return messages

    def pack_many(self, frames: Any, poses: Any) -> List[Message]:
        shape = self.loads.skin.shape if self.loads is not None else self.skin.shape
        if not isinstance(frames, numpy.ndarray) or frames.shape[1:] != shape:
            found = getattr(frames, "shape", type(frames).__name__)
            raise FrameError(f"frames.shape is {found}; it must be (frames, "
                             f"{', '.join(map(str, shape))})", reason="FRAME_SIZE_MISMATCH",
                             metadata={"field": "frames.shape", "value": str(found),
                                       "expected": f"(frames, {', '.join(map(str, shape))})"})
        if poses is not None and len(poses) != len(frames):
            raise FrameError(f"there are {len(poses)} poses; it must be {len(frames)}, one for "
                             "each frame", reason="INVALID_POSE")
        messages: List[Message] = []
        for i, frame in enumerate(frames):
            messages.extend(self.pack(frame, None, 0, None if poses is None else poses[i]))
        return messages

    def take(self) -> List[Answer]:
        """The answers that wait."""
        answers = self.answers
        taken: List[Answer] = []
        while answers:
            taken.append(answers.popleft())
        return taken

    def take_final(self) -> Answer:
        final = self.final
        if final is None:
            raise self.link.end_error()
        try:
            self.answers.remove(final)
        except ValueError:
            pass
        return final

    @property
    def trial_open(self) -> bool:
        return self.writer.pending > 0 or self.link.history.trial_frames > 0

    def statistics(self) -> StreamStatistics:
        return StreamStatistics(self.frames, self.link.resumed,
                                self.link.history.replayed_frames,
                                self.link.without_beginning, self.dropped)

    def _deliver(self, shown: Any, message: Optional[Message]) -> None:
        names = self._names
        # A server that breaks the contract may answer before the first frame.
        if names is None:
            return
        answer: Answer = object.__new__(Answer)
        values = answer.__dict__
        values["_message"] = shown
        values["_names"] = names
        values["_request"] = message
        if shown.events:
            self.events.extend(answer.events)
        if shown.is_final:
            self.final = answer
        answers = self.answers
        if len(answers) == _MOST_ANSWERS:
            self.dropped += 1
        answers.append(answer)

    def _notice(self, message: Any) -> None:
        notice = notice_of(message)
        if notice is not None:
            self.notices.append(notice)


class Stream:
    """A stream of one skin. Made by :meth:`tactus.Client.stream`::

        with client.stream(skin) as stream:
            for frame in frames:
                for answer in stream.push(frame):
                    react(answer)
            final = stream.end_trial()

    A stream that loses its connection, or its server, is resumed: the robot gets
    what it would have got from one unbroken stream, each answer once, with the
    same bits. While it is lost, ``push`` keeps the frame and returns at once.

    Belongs to one thread, but for ``cancel``, ``resuming``, ``ended`` and
    ``statistics``.
    """

    def __init__(self, core: StreamCore) -> None:
        self._core = core
        self._link = core.link

    @property
    def info(self) -> StreamInfo:
        """The model that answers: its version, classes and questions."""
        return self._core.info

    @property
    def skin(self) -> Skin:
        """The skin in use, with all values of a preset."""
        return self._core.skin

    @property
    def final(self) -> Optional[Answer]:
        """The final answer of the last trial that ended."""
        return self._core.final

    @property
    def notices(self) -> Tuple[Notice, ...]:
        """News about the stream, the oldest first; the last 64."""
        return tuple(self._core.notices)

    @property
    def resuming(self) -> bool:
        """True while a lost connection is being resumed."""
        return self._link.state is State.RESUMING

    @property
    def ended(self) -> bool:
        """True once no further answer can come."""
        return self._link.state is State.ENDED

    @property
    def statistics(self) -> StreamStatistics:
        return self._core.statistics()

    def push(self, frame: "numpy.typing.NDArray[Any]", capture_time_ns: Optional[int] = None, *,
             missing_before: int = 0, pose: Optional[Sequence[float]] = None) -> List[Answer]:
        """Sends a frame and returns the answers that have come.

        ``frame``: [rows, columns] or [rows, columns, 3], of the skin's dtype,
        C-contiguous. Its values times ``skin.scale`` are in ``skin.unit``.

        ``capture_time_ns``: when it was read, on the robot's clock, rising.
        Without, frames are one sample period apart, the first at 0.

        ``missing_before``: frames that the skin lost directly before this one.

        ``pose``: [7] x, y, z in metres and the unit quaternion qx, qy, qz, qw of
        the link that carries the skin, if the skin has poses.

        Raises :class:`tactus.FrameError` for a frame that the skin cannot have;
        the stream then goes on. Any other error has ended the stream.
        """
        core = self._core
        link = self._link
        if core.loads is not None or link.state is State.ENDED:
            messages = core.pack(frame, capture_time_ns, missing_before, pose)
        else:
            messages = core.writer.add(frame, capture_time_ns, missing_before, pose)
            core.frames += 1
        for message in messages:
            link.send(message)
        answers = core.answers
        return [answers.popleft()] if len(answers) == 1 else core.take()

    def push_many(self, frames: "numpy.typing.NDArray[Any]", *,
                  poses: Optional["numpy.typing.NDArray[Any]"] = None) -> List[Answer]:
        """Sends frames, [frames, rows, columns(, 3)], one sample period apart,
        with their poses [frames, 7]; returns the answers that have come."""
        for message in self._core.pack_many(frames, poses):
            self._link.send(message)
        return self._core.take()

    def flush(self) -> List[Answer]:
        """Sends the frames that wait for a message to be full."""
        for message in self._core.writer.flush():
            self._link.send(message)
        return self._core.take()

    def poll(self, timeout_s: float = 0.0) -> List[Answer]:
        """Returns the answers that have come; waits for one up to the timeout if
        there is none and a thread receives them."""
        if timeout_s > 0 and not (self._core.lockstep and self._link.state is State.CONNECTED):
            self._link.wait(timeout_s, lambda: bool(self._core.answers))
        return self._core.take()

    def events(self) -> List[Event]:
        """Takes the events that have come since the last call. They are in the
        answers, too."""
        events: List[Event] = []
        while self._core.events:
            events.append(self._core.events.popleft())
        return events

    def end_trial(self) -> Answer:
        """Ends the trial and returns its final answer. The next frame begins
        another. Interim answers that came with it wait for ``poll``."""
        for message in self._core.writer.flush():
            self._link.send(message)
        self._link.end_trial()
        return self._core.take_final()

    def close(self) -> Optional[Answer]:
        """Ends an open trial and the stream; returns the last final answer."""
        if self.ended:
            if self._link.error is not None:
                raise self._link.error
            return self._core.final
        if self._core.trial_open:
            self.end_trial()
        self._link.close()
        return self._core.final

    def cancel(self) -> None:
        """Ends the stream at once. Any thread may call it."""
        if not self.ended:
            self._link.cancel()

    def __enter__(self) -> "Stream":
        return self

    def __exit__(self, kind: Optional[Type[BaseException]], error: Optional[BaseException],
                 trace: Optional[TracebackType]) -> None:
        if kind is None:
            self.close()
        else:
            self.cancel()

    def __del__(self) -> None:
        link = getattr(self, "_link", None)
        if link is not None and link.state is not State.ENDED:
            link.cancel()

    def __repr__(self) -> str:
        return (f"<tactus.Stream of {self.skin.name} to {self.info.model_version}, "
                f"{self._link.state.name.lower()}, {self._core.frames} frames>")

    def _repr_html_(self) -> str:
        from tactus._svg import stream_html

        return stream_html(self)
