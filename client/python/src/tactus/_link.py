"""Link: the calls of one stream, one after the other.

When a call is lost, a thread opens another one, sends the frames again that the
answers depend on (_history.py), and hands over. What is resumed, and for how
long, follows the C++ client (client/stream/resumable_stream.h).

In lockstep, the caller's thread receives the answers, and there is no other
thread while the connection stands. Else a thread receives them.
"""

from __future__ import annotations

import enum
import random
import threading
import time
from dataclasses import dataclass
from typing import Any, Callable, Optional, Sequence, Tuple

import grpc

from tactus._call import Call, open_call
from tactus._errors import Error, from_status, invalid, may_retry, no_response, stream_finished
from tactus._frames import END_OF_TRIAL, Message
from tactus._history import MAX_REPLAY_BYTES, MIN_REPLAY_BYTES, StreamHistory
from tactus._watchdog import WATCHDOG
from tactus.v1 import contact_pb2

_FIRST_WAIT_S = 0.025
_LONGEST_WAIT_S = 5.0
# Messages that may wait for the transport before push waits, too.
_MOST_QUEUED = 64
_EVERY_N_FRAMES = 2

_Response = contact_pb2.ClassifyContactResponse


@dataclass(frozen=True)
class Timeouts:
    """Seconds; 0 is no limit."""

    #: How long a loss of a stream may last; 0: the first loss ends the stream.
    resume_for: float = 30.0
    #: How long a server may take: to accept a stream, to take a frame, for an
    #: answer that is due, and to end a stream.
    open: float = 10.0
    push: float = 10.0
    answer: float = 10.0
    close: float = 10.0


class State(enum.Enum):
    CONNECTED = 1
    RESUMING = 2
    ENDED = 3


class _End(Exception):
    """How a stream ends; without an error if the robot closed it."""

    def __init__(self, error: Optional[Error] = None) -> None:
        super().__init__()
        self.error = error


def _parse(payload: bytes) -> Any:
    try:
        return _Response.FromString(payload)
    except Exception as problem:  # Each implementation of protobuf has another one.
        raise _End(_broken("a response", "no ClassifyContactResponse")) from problem


def _after(seconds: float) -> Optional[float]:
    return time.monotonic() + seconds if seconds > 0 else None


class Link:
    """Send, end_trial and close belong to one thread; the callbacks run on the
    receiving one."""

    def __init__(self, channel: grpc.Channel, config: Any, metadata: Sequence[Tuple[str, str]],
                 *, timeouts: Timeouts, replay_bytes: int, lockstep: bool,
                 deliver: Callable[[Any, Optional[Message]], None],
                 notice: Callable[[Any], None], changed: Callable[[], None],
                 direct: Optional[bool] = None) -> None:
        if not MIN_REPLAY_BYTES <= replay_bytes <= MAX_REPLAY_BYTES:
            raise invalid("replay_bytes", replay_bytes,
                          f"{MIN_REPLAY_BYTES} to {MAX_REPLAY_BYTES}")
        self._channel = channel
        self._config = contact_pb2.StreamConfig()
        self._config.CopyFrom(config)
        self._metadata = metadata
        self._timeouts = timeouts
        self._lockstep = lockstep
        self.push_timeout = timeouts.push
        self._deliver = deliver
        self._notice = notice
        self._changed = changed
        self._direct = direct
        self._answers_are_due = config.cadence in (1, _EVERY_N_FRAMES)
        self._every_frame = config.cadence == 1
        self._interval: int = max(1, config.result_interval_frames)

        # Guards what follows, and tells of changes.
        self._mutex = threading.RLock()
        self._lock = threading.Condition(self._mutex)
        self.state = State.CONNECTED
        self.error: Optional[Error] = None
        self.resumed = 0
        self.without_beginning = 0
        # The last frame of `offer` whose answer is due.
        self.last_due = 0
        self._closing = False
        self._cancelled = False
        self._end_sent = False
        self._progressed = True
        self._lost_at = 0.0
        self._resumed_at = 0.0
        self._wait_s = _FIRST_WAIT_S
        self._receiving = False
        self._call: Optional[Call] = None

        self.started = self._open(timeouts.open, wait_for_ready=False)
        self._config.model = self.started.model_version
        self.history = StreamHistory(
            light_touch=self.started.geometry.HasField("light_touch"),
            interval=self._interval if config.cadence == _EVERY_N_FRAMES else 1,
            with_poses=config.with_poses, rate_hz=config.sample_rate_hz, max_bytes=replay_bytes)
        if not lockstep:
            self._start_thread(lost=False, error=None)

    # The caller's thread.

    def send(self, message: Message) -> None:
        """Sends frames; in lockstep also receives the answers that are due."""
        if not self._lockstep or self.state is not State.CONNECTED:
            deadline = time.monotonic() + (self._timeouts.push or float("inf"))
            with self._lock:
                while not (self._lockstep and self.state is State.CONNECTED):
                    if self.offer(message):
                        return
                    left = deadline - time.monotonic()
                    if left <= 0 and self.state is State.CONNECTED:
                        raise no_response("frames", self._timeouts.push)
                    self._lock.wait(0.05)
        history = self.history
        history.add(message, True)
        due = (message.last if self._every_frame
               else self._due(history.trial_frames, message))
        call = self._call
        assert call is not None
        if self._timeouts.answer > 0:
            call.due = time.monotonic() + self._timeouts.answer
        if due is None:
            call.post(message.request)
            return
        self._receiving = True
        try:
            payload = call.exchange(message.request)
        finally:
            self._receiving = False
        if payload is not None:
            # The usual case, without the detours of the others.
            try:
                answer = _Response.FromString(payload).answer
            except Exception:  # _take says so.
                answer = _Response().answer
            if answer.sequence == due and not answer.is_final:
                shown = history.take(answer)
                if shown is not None:
                    self._deliver(shown, message)
                call.due = None
                return
        last = due
        self._receive_until(lambda: history.answered >= last, message, payload)

    def offer(self, message: Message) -> bool:
        """Takes a message and does not wait; False if there is no room for it."""
        with self._lock:
            if self.state is State.ENDED:
                raise self.end_error()
            call = self._call
            if self.state is not State.CONNECTED:
                call = None
            if call is not None and call.queued() >= _MOST_QUEUED:
                return False
            if not self.history.add(message, call is not None):
                return False
            due = self._due(self.history.trial_frames, message)
            if due is not None:
                self.last_due = due
            if call is not None:
                call.post(message.request)
            else:
                self._lock.notify_all()
            return True

    def has_delivered(self, sequence: int) -> bool:
        """True if the answer to this frame, or to a later one, was delivered."""
        with self._mutex:
            return bool(self.history.delivered >= sequence)

    def is_ending(self) -> bool:
        """True from ``begin_end`` until the final answer was delivered."""
        with self._mutex:
            return bool(self.history.ending)

    def begin_end(self) -> None:
        """The trial will get no more frames; its final answer comes."""
        with self._lock:
            if self.state is State.ENDED:
                raise self.end_error()
            self.history.end_trial()
            self._end_sent = False
            self._lock.notify_all()
            if self.state is State.CONNECTED:
                self._end_sent = True
                assert self._call is not None
                self._call.due = _after(self._timeouts.answer)
                self._call.post(END_OF_TRIAL)
                if not self._lockstep:
                    return
        if self.state is State.CONNECTED:
            assert self._call is not None
            self._receive_until(lambda: not self.history.ending, None, self._call.receive())

    def end_trial(self) -> None:
        self.begin_end()
        with self._lock:
            while self.history.ending:
                if self.state is State.ENDED:
                    raise self.end_error()
                self._lock.wait(1.0)

    def begin_close(self) -> None:
        with self._lock:
            self._closing = True
            self._lock.notify_all()
            if self.state is State.CONNECTED and self._call is not None:
                self._call.due = _after(self._timeouts.close)
                self._call.half_close()

    def close(self) -> None:
        """Ends the stream; what it owed has come."""
        self.begin_close()
        if self._lockstep and self.state is State.CONNECTED:
            self._finish(self._judge(self._outcome()))
        with self._lock:
            while self.state is not State.ENDED:
                self._lock.wait(1.0)
        if self.error is not None:
            raise self.error

    def cancel(self) -> None:
        """Ends the stream at once. Any thread may call it."""
        with self._lock:
            self._cancelled = True
            call = self._call
            self._lock.notify_all()
            idle = self._lockstep and self.state is State.CONNECTED and not self._receiving
        if call is not None:
            call.cancel()
        if idle:
            self._outcome()
            self._finish(_End(_cancelled()))

    def wait(self, seconds: float, wanted: Callable[[], bool]) -> None:
        """Waits until something has come that is wanted."""
        deadline = time.monotonic() + seconds
        with self._lock:
            while not wanted() and self.state is not State.ENDED:
                left = deadline - time.monotonic()
                if left <= 0:
                    return
                self._lock.wait(left)

    def end_error(self) -> Error:
        return self.error or stream_finished()

    # The receiving thread: in lockstep the caller's, while it is connected.

    def _receive_until(self, done: Callable[[], bool], message: Optional[Message],
                       payload: Optional[bytes]) -> None:
        """Takes what was received, in lockstep, and receives more until it is
        done. None is the end of the call."""
        call = self._call
        assert call is not None
        self._receiving = True
        end: Optional[_End] = None
        try:
            while payload is not None:
                self._take(payload, message)
                if done():
                    call.due = None
                    return
                payload = call.receive()
        except _End as broken:
            call.cancel()
            end = broken
        finally:
            self._receiving = False
        lost = self._outcome("a frame" if message else "end_of_trial")
        end = end or self._judge(lost)
        if end is not None:
            self._finish(end)
            raise self.end_error()
        with self._lock:
            self.state = State.RESUMING
        self._start_thread(lost=True, error=lost)

    def _due(self, frames: int, message: Message) -> Optional[int]:
        """The last frame of a message that is answered whatever it holds;
        ``frames`` are those of the trial until its end."""
        if not self._answers_are_due:
            return None
        beyond = frames % self._interval
        if beyond >= message.frames:
            return None
        return message.first_sequence + message.frames - 1 - beyond

    def _take(self, payload: bytes, message: Optional[Message] = None) -> None:
        response = _parse(payload)
        if not response.HasField("answer"):
            if response.HasField("notice"):
                self._notice(response.notice)
            return
        answer = response.answer
        sequence = answer.sequence
        history = self.history
        with self._mutex:
            if sequence > history.last_sequence:
                raise _End(_broken("answer.sequence", f"{sequence}, of a frame to come"))
            if message is None or not (
                    0 <= sequence - message.first_sequence < message.frames):
                message = history.find(sequence)
            shown = history.take(answer)
            if shown is None:
                return
            self._progressed = True
            # Within the lock: who sees in the history that an answer has come
            # finds the answer.
            self._deliver(shown, message)
        if not self._lockstep or self.state is not State.CONNECTED:
            self._tell()

    def _tell(self) -> None:
        with self._lock:
            if not self.history.ending and self._call is not None and (
                    self.state is State.CONNECTED):
                self._call.due = None
            self._lock.notify_all()
        self._changed()

    def _open(self, timeout: float, wait_for_ready: bool) -> Any:
        """Opens a call, and returns the server's StreamStarted."""
        request = contact_pb2.ClassifyContactRequest(config=self._config)
        call = open_call(self._channel, self._metadata, request.SerializeToString(),
                         wait_for_ready=wait_for_ready, direct=self._direct)
        call.due = _after(timeout)
        with self._lock:
            self._call = call
            if self._cancelled:
                call.cancel()
        WATCHDOG.watch(call)
        payload = call.receive()
        if payload is None:
            raise self._outcome("config", timeout) or stream_finished()
        call.due = None
        response = _Response.FromString(payload)
        if not response.HasField("started"):
            call.cancel()
            self._outcome()
            raise _broken("the first response", "no StreamStarted")
        return response.started

    def _outcome(self, what: str = "a frame", timeout: float = 0.0) -> Optional[Error]:
        """Waits for the end of the call; None if it ended with OK."""
        call = self._call
        assert call is not None
        code, text, details = call.outcome()
        WATCHDOG.forget(call)
        self._call = None
        if call.expired:
            return no_response(what, timeout or self._timeouts.answer)
        return None if code == 0 else from_status(code, text, details)

    def _judge(self, error: Optional[Error]) -> Optional[_End]:
        """How all ends after a call that ended with ``error``; None if the
        stream is to be resumed."""
        if self._cancelled:
            return _End(_cancelled())
        if error is not None and not (may_retry(error)
                                      or error.reason in ("STREAM_IDLE", "STREAM_LIMIT")):
            return _End(error)
        if self._closing and not self._owes():
            return _End()
        if self._timeouts.resume_for > 0:
            return None
        return _End(error or stream_finished())

    def _owes(self) -> bool:
        return self.history.ending or self.history.trial_frames > 0

    def _finish(self, end: Optional[_End]) -> None:
        with self._lock:
            self.error = end.error if end is not None else None
            self.state = State.ENDED
            self._lock.notify_all()
        self._changed()

    # The thread that resumes, and that receives unless it is lockstep.

    def _start_thread(self, lost: bool, error: Optional[Error]) -> None:
        threading.Thread(target=self._run, args=(lost, error), name="tactus-stream",
                         daemon=True).start()

    def _run(self, lost: bool, error: Optional[Error]) -> None:
        try:
            while True:
                if not lost:
                    error = self._receive_all()
                with self._lock:
                    end = self._judge(error)
                    if end is not None:
                        raise end
                    self.state = State.RESUMING
                self._changed()
                self._resume(error)
                self._changed()
                if self._lockstep:
                    return
                lost = False
        except _End as end:
            self._finish(end)
        except Exception as problem:  # Whatever it is, nobody may wait for ever.
            self._finish(_End(_broken("the stream", repr(problem))))

    def _receive_all(self) -> Optional[Error]:
        call = self._call
        assert call is not None
        try:
            while True:
                payload = call.receive()
                if payload is None:
                    return self._outcome()
                self._take(payload)
        except _End:
            call.cancel()
            self._outcome()
            raise

    def _resume(self, error: Optional[Error]) -> None:
        """Opens calls until one has got all frames; raises _End instead."""
        if error is not None and error.reason == "STREAM_IDLE":
            with self._lock:
                while not (self.history.has_unsent or self.history.ending or self._closing
                           or self._cancelled):
                    self._lock.wait(1.0)
        # A call that is soon lost again, without a new answer, continues the
        # loss before; so does a server that never sends a final.
        now = time.monotonic()
        if not self.history.ending and now - self._resumed_at > self._timeouts.resume_for:
            self._progressed = True
        while True:
            if self._progressed:
                self._progressed = False
                self._lost_at = time.monotonic()
                self._wait_s = _FIRST_WAIT_S
            end = self._judge(error)
            if end is not None:
                raise end
            deadline = self._lost_at + self._timeouts.resume_for
            if time.monotonic() >= deadline:
                raise _End(_not_resumed(self._timeouts.resume_for, error))
            # Random, so that many robots do not return at the same moment.
            wait = self._wait_s * random.uniform(0.5, 1.0)
            self._wait_s = min(2 * self._wait_s, _LONGEST_WAIT_S)
            attempt = min(time.monotonic() + wait, deadline)
            with self._lock:
                while time.monotonic() < attempt and not self._cancelled and not (
                        self._closing and not self._owes()):
                    self._lock.wait(max(0.0, attempt - time.monotonic()))
            if self._cancelled or (self._closing and not self._owes()):
                continue
            try:
                self._open_again(deadline)
                if self._catch_up():
                    return
                error = self._outcome()
            except Error as failed:
                error = failed

    def _open_again(self, deadline: float) -> None:
        with self._lock:
            self._end_sent = False
            whole = self.history.begin_stream()
        left = max(deadline - time.monotonic(), 0.1)
        limit = self._timeouts.open
        started = self._open(min(limit, left) if limit > 0 else left, wait_for_ready=True)
        if started.bundle_sha256 != self.started.bundle_sha256:
            if self._call is not None:
                self._call.cancel()
                self._outcome()
            raise _End(Error(
                f"{self.started.model_version} is another model than before: its SHA-256 is "
                f"{started.bundle_sha256}; it must be {self.started.bundle_sha256}",
                code="FAILED_PRECONDITION", reason="INVALID_MODEL", advice="open a new stream"))
        with self._lock:
            self.resumed += 1
            if not whole:
                self.without_beginning += 1

    def _catch_up(self) -> bool:
        """Sends all that the call has not got. False if it ended."""
        call = self._call
        assert call is not None
        while True:
            ending = False
            with self._lock:
                if self._cancelled:
                    return False
                record = self.history.next_unsent()
                if record is None:
                    if self.history.ending and not self._end_sent:
                        ending = self._end_sent = True
                    elif not (self.history.ending and self._lockstep):
                        self._resumed_at = time.monotonic()
                        self.state = State.CONNECTED
                        self._lock.notify_all()
                        return True
                else:
                    # Push may wait for room.
                    self._lock.notify_all()
            call.due = _after(self._timeouts.answer)
            if record is None:
                if ending:
                    call.post(END_OF_TRIAL)
                if not self._lockstep:
                    continue
                payload = call.receive()
            else:
                due = self._due(record.frames_before + record.frames, record)
                if due is None:
                    call.post(record.request)
                    continue
                payload = call.exchange(record.request)
                while payload is not None:
                    self._take(payload, record)
                    if self.history.answered >= due:
                        break
                    payload = call.receive()
                if payload is not None:
                    call.due = None
                    continue
            if payload is None:
                return False
            self._take(payload)
            call.due = None


def _cancelled() -> Error:
    return Error("the stream was cancelled", reason="CANCELLED", code="CANCELLED")


def _broken(what: str, value: str) -> Error:
    return Error(f"{what} is {value}", reason="INVALID_RESPONSE", code="INTERNAL")


def _not_resumed(seconds: float, error: Optional[Error]) -> Error:
    text = str(error) if error is not None else "the server ended the stream"
    return Error(f"the stream was lost, and not resumed within {seconds:g} s: {text}",
                 reason="NO_RESPONSE", code="DEADLINE_EXCEEDED")
