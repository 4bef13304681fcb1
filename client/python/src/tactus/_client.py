"""Client: the connection to a Tactus server."""

from __future__ import annotations

import os
from types import TracebackType
from typing import Any, Optional, Type

import grpc

from tactus._calibration import Calibration
from tactus._errors import Error, invalid
from tactus._history import MAX_REPLAY_BYTES
from tactus._link import Timeouts
from tactus._options import StreamOptions
from tactus._skin import Skin
from tactus._stream import Connection, Stream, StreamCore

# As the C++ client: the keep-alive that the server expects, no compression, and
# no repetition of calls beside ours.
_CHANNEL_OPTIONS = (
    ("grpc.keepalive_time_ms", 20_000),
    ("grpc.keepalive_timeout_ms", 10_000),
    ("grpc.http2.max_pings_without_data", 0),
    ("grpc.http2.bdp_probe", 0),
    ("grpc.compression_enabled_algorithms_bitset", 1),
    ("grpc.per_message_decompression", 0),
    ("grpc.enable_retries", 0),
    ("grpc.initial_reconnect_backoff_ms", 100),
    ("grpc.min_reconnect_backoff_ms", 100),
    ("grpc.max_reconnect_backoff_ms", 1_000),
    ("grpc.max_receive_message_length", 4 * 1024 * 1024),
)


class Client:
    def __init__(self, address: Optional[str] = None, *, tls_ca: Optional[str] = None,
                 token: Optional[str] = None, token_file: Optional[str] = None,
                 resume_for: float = 30.0, replay_bytes: int = MAX_REPLAY_BYTES,
                 open_timeout: float = 10.0, push_timeout: float = 10.0,
                 answer_timeout: float = 10.0, close_timeout: float = 10.0,
                 direct: Optional[bool] = None) -> None:
        self.address = address or os.environ.get("TACTUS_SERVER", "")
        self._channel = grpc.insecure_channel(self.address, options=_CHANNEL_OPTIONS)
        self._connection = Connection(
            self._channel, (), Timeouts(resume_for, open_timeout, push_timeout, answer_timeout,
                                        close_timeout), replay_bytes, direct)

    def stream(self, skin: Skin, *, calibration: Optional[Calibration] = None, tare: int = 0,
               drift_s: float = 0.0, **options: Any) -> Any:
        return Stream(StreamCore(self._connection, skin, StreamOptions(**options), calibration,
                                 tare, drift_s, lambda: None))

    def close(self) -> None:
        self._channel.close()

    def __enter__(self) -> "Client":
        return self

    def __exit__(self, kind: Optional[Type[BaseException]], error: Optional[BaseException],
                 trace: Optional[TracebackType]) -> None:
        self.close()
