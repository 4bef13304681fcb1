"""One call of ClassifyContact, as bytes.

``DirectCall`` runs the call on the thread that asks for its answers, with the
layer below grpc's public one that grpc itself uses for calls of a single thread:
a frame then takes a third of the time. grpc may change that layer, so
``PlainCall`` does the same with the public one, and is used where the other is
not there.
"""

from __future__ import annotations

import queue
import threading
from collections import deque
from typing import Any, Deque, Iterator, NamedTuple, Optional, Sequence, Tuple

import grpc

from tactus._errors import details_of

try:
    from grpc._cython import cygrpc
except ImportError:  # A grpc of another make.
    cygrpc = None

METHOD = "/tactus.v1.ContactService/ClassifyContact"
_CANCELLED = 1

Metadata = Sequence[Tuple[str, str]]


class Outcome(NamedTuple):
    """How a call ended: code, text, and its serialised Status."""

    code: int
    message: str
    details: bytes


class Call:
    """What a stream needs of a call.

    One thread at a time calls all of it; ``post`` and ``cancel`` may be called
    from others.
    """

    #: The watchdog cancels the call at this time (time.monotonic) if it is set.
    due: Optional[float] = None
    #: The watchdog has done so.
    expired = False

    def post(self, message: bytes) -> None:
        """Sends a message and does not wait."""
        raise NotImplementedError

    def queued(self) -> int:
        """How many messages wait to be sent."""
        raise NotImplementedError

    def exchange(self, message: bytes) -> Optional[bytes]:
        """Sends a message and returns the next response; None after the last."""
        self.post(message)
        return self.receive()

    def receive(self) -> Optional[bytes]:
        """Returns the next response; None after the last."""
        raise NotImplementedError

    def half_close(self) -> None:
        """Nothing will be sent any more."""
        raise NotImplementedError

    def cancel(self) -> None:
        raise NotImplementedError

    def outcome(self) -> Outcome:
        """Waits for the end of the call and returns it. Nothing may be received
        after it."""
        raise NotImplementedError


class PlainCall(Call):
    """A call through grpc's public interface."""

    def __init__(self, channel: grpc.Channel, metadata: Metadata, first: bytes,
                 wait_for_ready: bool) -> None:
        self._queue: "queue.SimpleQueue[Optional[bytes]]" = queue.SimpleQueue()
        self._queue.put(first)
        requests: Iterator[Optional[bytes]] = iter(self._queue.get, None)
        self._rpc = channel.stream_stream(METHOD)(
            requests, metadata=tuple(metadata), wait_for_ready=wait_for_ready)

    def post(self, message: bytes) -> None:
        self._queue.put(message)

    def queued(self) -> int:
        return self._queue.qsize()

    def receive(self) -> Optional[bytes]:
        try:
            response: bytes = next(self._rpc)
            return response
        except (StopIteration, grpc.RpcError):
            return None

    def half_close(self) -> None:
        self._queue.put(None)

    def cancel(self) -> None:
        self._rpc.cancel()
        self._queue.put(None)

    def outcome(self) -> Outcome:
        while self.receive() is not None:
            pass
        self._queue.put(None)
        return Outcome(self._rpc.code().value[0], self._rpc.details() or "",
                       details_of(self._rpc.trailing_metadata()))


# Names of the batches of operations of a DirectCall.
_BEGIN, _SEND, _RECEIVE, _BOTH, _STATUS, _CLOSE = range(6)


class DirectCall(Call):
    """A call without threads."""

    def __init__(self, channel: grpc.Channel, metadata: Metadata, first: bytes,
                 wait_for_ready: bool) -> None:
        self._receive = (cygrpc.ReceiveMessageOperation(0),)
        self._make_send = cygrpc.SendMessageOperation
        # Guards what post and the receiving thread share.
        self._lock = threading.Lock()
        self._sending = True
        self._queue: Deque[Optional[bytes]] = deque()
        self._open = 3
        self._message: Optional[bytes] = None
        self._received = False
        self._over = False
        self._outcome: Optional[Outcome] = None
        flags = 0
        if wait_for_ready:
            flags = (cygrpc.InitialMetadataFlags.wait_for_ready
                     | cygrpc.InitialMetadataFlags.wait_for_ready_explicitly_set)
        self._call = channel._channel.segregated_call(
            0, METHOD.encode(), None, None, tuple(metadata), None, (
                ((cygrpc.SendInitialMetadataOperation(tuple(metadata), flags),
                  self._make_send(first, 0)), _SEND),
                ((cygrpc.ReceiveStatusOnClientOperation(0),), _STATUS),
                ((cygrpc.ReceiveInitialMetadataOperation(0),), _BEGIN)))
        self._operate = self._call.operate
        self._next_event = self._call.next_event

    def post(self, message: Optional[bytes]) -> None:
        with self._lock:
            if self._sending:
                self._queue.append(message)
            else:
                self._send(message)

    def queued(self) -> int:
        return len(self._queue)

    def exchange(self, message: bytes) -> Optional[bytes]:
        while self._sending and not self._over:
            self._pump()
        if self._over or not self._operate(
                (self._make_send(message, 0), *self._receive), _BOTH):
            self._over = True
            return None
        self._open += 1
        try:
            event = self._next_event()
            while event.tag != _BOTH:
                self._take(event)
                event = self._next_event()
        except BaseException:
            self._destroyed()
            raise
        self._open -= 1
        response: Optional[bytes] = event.batch_operations[1].message()
        if response is None:
            self._over = True
        return response

    def receive(self) -> Optional[bytes]:
        if self._over or not self._operate(self._receive, _RECEIVE):
            self._over = True
            return None
        with self._lock:
            self._open += 1
        self._received = False
        while not self._received:
            self._pump()
        return self._message

    def half_close(self) -> None:
        self.post(None)

    def cancel(self) -> None:
        self._call.cancel(_CANCELLED, "Cancelled by the client")

    def outcome(self) -> Outcome:
        while not self._over:
            self.receive()
        # All batches end with the call. Their memory is only given back when
        # they have been taken.
        while self._open > 0:
            self._pump()
        return self._outcome or Outcome(2, "the call has no status", b"")

    def _send(self, message: Optional[bytes]) -> None:
        if message is None:
            begun = self._operate((cygrpc.SendCloseFromClientOperation(0),), _CLOSE)
        else:
            begun = self._operate((self._make_send(message, 0),), _SEND)
        if begun:
            self._sending = True
            self._open += 1

    def _pump(self) -> None:
        try:
            event = self._next_event()
        except BaseException:
            self._destroyed()
            raise
        self._take(event)

    def _destroyed(self) -> None:
        """Ctrl-C ends a wait, and grpc destroys the call then."""
        self._over = True
        self._open = 0
        self._outcome = Outcome(_CANCELLED, "the wait for the server was interrupted", b"")

    def _take(self, event: Any) -> None:
        tag = event.tag
        with self._lock:
            self._open -= 1
            if tag == _SEND or tag == _CLOSE:
                self._sending = False
                if self._queue and not self._over:
                    self._send(self._queue.popleft())
        if tag == _RECEIVE:
            self._message = event.batch_operations[0].message()
            self._received = True
            if self._message is None:
                self._over = True
        elif tag == _STATUS:
            status = event.batch_operations[0]
            details = status.details()
            self._outcome = Outcome(
                status.code(), details.decode() if isinstance(details, bytes) else details or "",
                details_of(status.trailing_metadata()))


def has_direct_calls(channel: grpc.Channel) -> bool:
    """True if this grpc has what DirectCall needs."""
    names = ("SendInitialMetadataOperation", "SendMessageOperation", "ReceiveMessageOperation",
             "ReceiveStatusOnClientOperation", "ReceiveInitialMetadataOperation",
             "SendCloseFromClientOperation", "InitialMetadataFlags")
    return (cygrpc is not None and all(hasattr(cygrpc, name) for name in names)
            and hasattr(getattr(channel, "_channel", None), "segregated_call"))


def open_call(channel: grpc.Channel, metadata: Metadata, first: bytes, *,
              wait_for_ready: bool, direct: Optional[bool] = None) -> Call:
    """Begins a call with its first message."""
    if direct or (direct is None and has_direct_calls(channel)):
        try:
            return DirectCall(channel, metadata, first, wait_for_ready)
        except (AttributeError, TypeError):
            if direct:
                raise
    return PlainCall(channel, metadata, first, wait_for_ready)
