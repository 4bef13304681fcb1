"""Client: the connection to a Tactus server."""

from __future__ import annotations

import asyncio
import functools
from types import TracebackType
from typing import Any, Callable, Optional, Type

from tactus._async import AsyncStream, Waker
from tactus._calibration import Calibration
from tactus._connection import Api, connect
from tactus._history import MAX_REPLAY_BYTES
from tactus._link import Link, Timeouts
from tactus._options import StreamOptions
from tactus._service import Service
from tactus._skin import Skin
from tactus._stream import Connection, Stream, StreamCore


class StreamContext:
    """A stream to be: ``with`` opens a :class:`Stream`, ``async with`` an
    :class:`AsyncStream`."""

    def __init__(self, connection: Connection, skin: Skin, options: StreamOptions,
                 calibration: Optional[Calibration], tare: int, drift_s: float) -> None:
        self._connection = connection
        self._arguments = (skin, options, calibration, tare, drift_s)
        self._waits = options.wait and options.cadence == "interval"
        self._stream: Optional[Stream] = None
        self._async: Optional[AsyncStream] = None

    def open(self) -> Stream:
        return Stream(self._make(lambda: None))

    def _make(self, changed: Callable[[], None], in_loop: bool = False) -> StreamCore:
        skin, options, calibration, tare, drift_s = self._arguments

        def link(config: Any, lockstep: bool, deliver: Any, notice: Any) -> Link:
            return self._connection.link(options.client_id, config, lockstep, deliver, notice,
                                         changed)

        return StreamCore(link, skin, options, calibration, tare, drift_s, in_loop)

    def __enter__(self) -> Stream:
        self._stream = self.open()
        return self._stream

    def __exit__(self, kind: Optional[Type[BaseException]], error: Optional[BaseException],
                 trace: Optional[TracebackType]) -> None:
        assert self._stream is not None
        self._stream.__exit__(kind, error, trace)

    async def __aenter__(self) -> AsyncStream:
        loop = asyncio.get_running_loop()
        waker = Waker(loop)
        core = await loop.run_in_executor(
            None, functools.partial(self._make, waker, in_loop=True))
        self._async = waker.stream = AsyncStream(core, self._waits)
        return self._async

    async def __aexit__(self, kind: Optional[Type[BaseException]],
                        error: Optional[BaseException], trace: Optional[TracebackType]) -> None:
        assert self._async is not None
        await self._async.__aexit__(kind, error, trace)


class Client(Service):
    """The connection to a server, on which the skins of a robot have their
    streams, and people their datasets, jobs and models::

        client = tactus.Client("arm.lab:50051", tls_ca="ca.crt",
                               token_file="arm-7.token")
        with client.stream(palm) as hand, client.stream(forearm) as arm:
            ...

    ``address`` is "host:port" or "unix:path"; without it, TACTUS_SERVER names
    it. ``tls_ca`` (TACTUS_TLS_CA) is a PEM file of the authorities that may
    vouch for the server; it turns TLS on. ``token_file`` (TACTUS_TOKEN_FILE) has
    the token that the server knows you by; ``token`` is the token itself. A token
    is sent only over TLS, to this host or to a unix socket.

    Connects with the first call. ``resume_for`` is how many seconds a loss of a
    stream may last, 0 for none; ``replay_bytes``, 256 KiB to 16 MiB, is what a
    stream keeps of its trial to resume it. The timeouts, in seconds, are how long
    a server may take; 0 is no limit.

    Any thread may use it; a stream belongs to one thread.
    """

    def __init__(self, address: Optional[str] = None, *, tls_ca: Optional[str] = None,
                 token: Optional[str] = None, token_file: Optional[str] = None,
                 resume_for: float = 30.0, replay_bytes: int = MAX_REPLAY_BYTES,
                 open_timeout: float = 10.0, push_timeout: float = 10.0,
                 answer_timeout: float = 10.0, close_timeout: float = 10.0,
                 call_timeout: float = 60.0, direct: Optional[bool] = None) -> None:
        self.address, self._channel, metadata = connect(address, tls_ca, token, token_file)
        self._connection = Connection(
            self._channel, metadata, Timeouts(resume_for, open_timeout, push_timeout,
                                              answer_timeout, close_timeout),
            replay_bytes, direct)
        super().__init__(Api(self._connection, call_timeout))

    def stream(self, skin: Skin, *, calibration: Optional[Calibration] = None, tare: int = 0,
               drift_s: float = 0.0, **options: Any) -> StreamContext:
        """A stream for ``with`` or ``async with``.

        ``options`` are those of :class:`tactus.StreamOptions`. With a
        ``calibration``, or a ``tare`` of that many untouched frames at the
        start, frames are what the skin sends, and loads are computed here;
        ``drift_s`` follows the drift of untouched taxels.

        Raises the server's error: INVALID_CONFIG and UNKNOWN_LAYOUT for a wrong
        skin, MODEL_NOT_FOUND, GEOMETRY_MISMATCH if the model was trained on
        another skin, NO_RESPONSE after the timeout.
        """
        return StreamContext(self._connection, skin, StreamOptions(**options), calibration, tare,
                             drift_s)

    def open(self, skin: Skin, **options: Any) -> Stream:
        """The same for programs that close the stream themselves."""
        return self.stream(skin, **options).open()

    def close(self) -> None:
        """Closes the connection; streams that are open are lost."""
        self._channel.close()

    def __enter__(self) -> "Client":
        return self

    def __exit__(self, kind: Optional[Type[BaseException]], error: Optional[BaseException],
                 trace: Optional[TracebackType]) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"<tactus.Client of {self.address}>"
