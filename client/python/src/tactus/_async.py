"""AsyncStream: a stream for programs with an event loop."""

from __future__ import annotations

import asyncio
from collections import deque
from types import TracebackType
from typing import Any, AsyncIterator, Callable, Deque, Generator, List, Optional, Sequence, \
    Tuple, Type

import numpy.typing

from tactus._answers import Answer, Event, Notice, StreamInfo
from tactus._errors import no_response
from tactus._frames import Message
from tactus._link import State
from tactus._skin import Skin
from tactus._stream import StreamCore, StreamStatistics


class Answers:
    """The answers of a push: ``async for answer in ...``, or ``await`` for a
    list of them."""

    def __init__(self, stream: "AsyncStream", due: int) -> None:
        self._stream = stream
        self._due = due

    def __aiter__(self) -> AsyncIterator[Answer]:
        return self

    async def __anext__(self) -> Answer:
        stream = self._stream
        answers = stream._core.answers
        while not answers:
            if stream._backlog:
                await stream._drain()
                if stream._waits:
                    self._due = stream._link.last_due
            if not await stream._more(self._due):
                raise StopAsyncIteration
        return answers.popleft()

    def __await__(self) -> Generator[Any, None, List[Answer]]:
        return self._all().__await__()

    async def _all(self) -> List[Answer]:
        return [answer async for answer in self]


class AsyncStream:
    """A stream of one skin for one task of an event loop::

        async with client.stream(skin) as stream:
            async for frame in skin_frames():
                async for answer in stream.push(frame):
                    react(answer)
            final = await stream.end_trial()

    As :class:`tactus.Stream`, with the same answers. A thread receives them, so
    the loop never waits for the network.
    """

    def __init__(self, core: StreamCore, waits: bool) -> None:
        self._core = core
        self._link = core.link
        self._waits = waits
        self._backlog: Deque[Message] = deque()
        self._loop = asyncio.get_running_loop()
        self._waiters: List["asyncio.Future[None]"] = []

    @property
    def info(self) -> StreamInfo:
        return self._core.info

    @property
    def skin(self) -> Skin:
        return self._core.skin

    @property
    def final(self) -> Optional[Answer]:
        return self._core.final

    @property
    def notices(self) -> Tuple[Notice, ...]:
        return tuple(self._core.notices)

    @property
    def resuming(self) -> bool:
        return self._link.state is State.RESUMING

    @property
    def ended(self) -> bool:
        return self._link.state is State.ENDED

    @property
    def statistics(self) -> StreamStatistics:
        return self._core.statistics()

    def push(self, frame: "numpy.typing.NDArray[Any]", capture_time_ns: Optional[int] = None, *,
             missing_before: int = 0, pose: Optional[Sequence[float]] = None) -> Answers:
        """As :meth:`tactus.Stream.push`. The frame is sent at once; iterating
        waits for its answer, if one is due and the connection stands."""
        self._backlog.extend(self._core.pack(frame, capture_time_ns, missing_before, pose))
        self._offer()
        return Answers(self, self._link.last_due if self._waits else 0)

    def push_many(self, frames: "numpy.typing.NDArray[Any]", *,
                  poses: Optional["numpy.typing.NDArray[Any]"] = None) -> Answers:
        """As :meth:`tactus.Stream.push_many`."""
        self._backlog.extend(self._core.pack_many(frames, poses))
        self._offer()
        return Answers(self, self._link.last_due if self._waits else 0)

    async def poll(self, timeout_s: float = 0.0) -> List[Answer]:
        """Returns the answers that have come; waits for one up to the timeout."""
        if timeout_s > 0 and not self._core.answers and not self.ended:
            try:
                await asyncio.wait_for(self._change(), timeout_s)
            except asyncio.TimeoutError:
                pass
        return self._core.take()

    def events(self) -> List[Event]:
        """Takes the events that have come since the last call."""
        events: List[Event] = []
        while self._core.events:
            events.append(self._core.events.popleft())
        return events

    async def end_trial(self) -> Answer:
        """Ends the trial and returns its final answer."""
        self._backlog.extend(self._core.writer.flush())
        await self._drain()
        self._link.begin_end()
        while self._link.is_ending():
            if self.ended:
                raise self._link.end_error()
            await self._change(lambda: not self._link.is_ending() or self.ended)
        return self._core.take_final()

    async def close(self) -> Optional[Answer]:
        """Ends an open trial and the stream; returns the last final answer."""
        if not self.ended:
            if self._core.trial_open or self._backlog:
                await self.end_trial()
            self._link.begin_close()
            while not self.ended:
                await self._change(lambda: self.ended)
        if self._link.error is not None:
            raise self._link.error
        return self._core.final

    def cancel(self) -> None:
        """Ends the stream at once."""
        self._backlog.clear()
        if not self.ended:
            self._link.cancel()

    async def __aenter__(self) -> "AsyncStream":
        return self

    async def __aexit__(self, kind: Optional[Type[BaseException]],
                        error: Optional[BaseException], trace: Optional[TracebackType]) -> None:
        if kind is None:
            await self.close()
        else:
            self.cancel()

    def __del__(self) -> None:
        link = getattr(self, "_link", None)
        if link is not None and link.state is not State.ENDED:
            link.cancel()

    def _offer(self) -> bool:
        while self._backlog:
            if not self._link.offer(self._backlog[0]):
                return False
            self._backlog.popleft()
        return True

    async def _drain(self) -> None:
        timeout = self._link.push_timeout
        deadline = self._loop.time() + (timeout or float("inf"))
        while not self._offer():
            if self._loop.time() >= deadline and not self.resuming:
                raise no_response("frames", timeout)
            # The transport does not say when it has room.
            await asyncio.sleep(0.01)

    async def _more(self, due: int) -> bool:
        """Waits for an answer; False if the one to frame ``due`` has come, or
        does not come soon."""
        def arrived() -> bool:
            return bool(self._core.answers) or self._link.has_delivered(due) or (
                self._link.state is not State.CONNECTED)

        # What wakes it may be an answer that was taken before.
        while not arrived():
            await self._change(arrived)
        if self.ended and not self._core.answers and self._link.error is not None:
            raise self._link.error
        return bool(self._core.answers)

    async def _change(self, wanted: Callable[[], bool] = lambda: False) -> None:
        """Waits until something has changed, unless ``wanted`` holds already."""
        waiter: "asyncio.Future[None]" = self._loop.create_future()
        self._waiters.append(waiter)
        try:
            # What changed before the waiter was there is seen here.
            if not wanted():
                await waiter
        finally:
            if waiter in self._waiters:
                self._waiters.remove(waiter)

    def _wake(self) -> None:
        for waiter in self._waiters:
            if not waiter.done():
                waiter.set_result(None)
        self._waiters.clear()


class Waker:
    """Wakes an AsyncStream from the thread that receives its answers."""

    def __init__(self, loop: asyncio.AbstractEventLoop) -> None:
        self._loop = loop
        self.stream: Optional[AsyncStream] = None

    def __call__(self) -> None:
        stream = self.stream
        if stream is None:
            return
        try:
            self._loop.call_soon_threadsafe(stream._wake)
        except RuntimeError:
            pass  # The loop is closed, and nobody waits.
