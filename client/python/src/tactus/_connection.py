"""The connection to a server: its channel, who calls, and single calls."""

from __future__ import annotations

import ipaddress
import os
import time
from typing import Any, Callable, Dict, Iterable, Iterator, Optional, Tuple, TypeVar

import grpc

from tactus._errors import Error, from_rpc, invalid, may_retry, no_response
from tactus._stream import Connection

T = TypeVar("T")

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
    # A server that restarts is found again within a second.
    ("grpc.initial_reconnect_backoff_ms", 100),
    ("grpc.max_reconnect_backoff_ms", 1_000),
    ("grpc.max_receive_message_length", 64 * 1024 * 1024),
)
_MOST_TOKEN_BYTES = 4_096
_RETRIES = 10


def stays_on_this_host(address: str) -> bool:
    """True if nothing that is sent there leaves this host.

    >>> stays_on_this_host("127.0.0.1:50051"), stays_on_this_host("arm.lab:50051")
    (True, False)
    """
    if address.startswith("unix:"):
        return True
    host = address.rpartition(":")[0].strip("[]")
    if host == "localhost":
        return True
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False


def _read(path: str, most: int) -> bytes:
    try:
        with open(path, "rb") as file:
            return file.read(most)
    except OSError as error:
        raise Error(f"{path}: {error.strerror}", reason="IO", code="UNAVAILABLE",
                    metadata={"path": path}) from error


def read_roots(path: str) -> bytes:
    """The certificates of a PEM file."""
    text = _read(path, 16 * 1024 * 1024)
    if b"-----BEGIN CERTIFICATE-----" not in text:
        raise Error(f"{path}: holds no PEM certificate", reason="IO", code="UNAVAILABLE",
                    metadata={"path": path})
    return text


def read_token(path: str) -> str:
    """The token of a file that holds nothing else."""
    token = _read(path, _MOST_TOKEN_BYTES).decode("utf-8", "replace").strip()
    if not token or not all("!" <= c <= "~" for c in token):
        raise Error(f"{path}: holds no token, which is one word of ASCII", reason="IO",
                    code="UNAVAILABLE", metadata={"path": path})
    return token


def connect(address: Optional[str], tls_ca: Optional[str], token: Optional[str],
            token_file: Optional[str]) -> Tuple[str, grpc.Channel, Tuple[Tuple[str, str], ...]]:
    """The address, a channel, and the metadata of all calls."""
    address = address or os.environ.get("TACTUS_SERVER", "")
    if not address:
        raise invalid("address", "absent", "the address of a server, like 127.0.0.1:50051; the "
                      "variable TACTUS_SERVER may hold it too")
    tls_ca = tls_ca if tls_ca is not None else os.environ.get("TACTUS_TLS_CA", "")
    if token is None and token_file is None:
        token_file = os.environ.get("TACTUS_TOKEN_FILE")
    if token_file:
        token = read_token(token_file)
    if token and not tls_ca and not stays_on_this_host(address):
        raise invalid(f"the connection to {address}", "plain",
                      "TLS (tls_ca=), because a token must not leave this host unencrypted")
    if tls_ca:
        roots = read_roots(tls_ca)
    if tls_ca and not address.startswith("unix:"):
        channel = grpc.secure_channel(address, grpc.ssl_channel_credentials(roots),
                                      options=_CHANNEL_OPTIONS)
    else:
        channel = grpc.insecure_channel(address, options=_CHANNEL_OPTIONS)
    metadata = (("authorization", f"Bearer {token}"),) if token else ()
    return address, channel, metadata


class Api:
    """Single calls to the services of ``tactus.v1``."""

    def __init__(self, connection: Connection, timeout_s: float) -> None:
        self._connection = connection
        self.timeout_s = timeout_s
        self.long_timeout_s = 10 * timeout_s
        self._methods: Dict[str, Any] = {}

    def call(self, method: str, request: Any, response: Any, *, long: bool = False,
             again: bool = False) -> Any:
        """Calls ``Service/Method``; repeats it if that has no other effect
        (``again``) and it broke on its way."""
        timeout = self.long_timeout_s if long else self.timeout_s
        stub = self._stub("unary_unary", method, response)

        def once() -> Any:
            try:
                return stub(request, timeout=timeout, metadata=self._connection.metadata)
            except grpc.RpcError as error:
                raise self._error(error, method, timeout) from None

        return repeated(once) if again else once()

    def send(self, method: str, requests: Iterable[Any], response: Any) -> Any:
        """Calls a method that takes a stream."""
        stub = self._stub("stream_unary", method, response)
        try:
            return stub(iter(requests), timeout=self.long_timeout_s,
                        metadata=self._connection.metadata)
        except grpc.RpcError as error:
            raise self._error(error, method, self.long_timeout_s) from None

    def receive(self, method: str, request: Any, response: Any,
                timeout_s: Optional[float] = None) -> Iterator[Any]:
        """Calls a method that returns a stream."""
        stub = self._stub("unary_stream", method, response)
        call = stub(request, timeout=timeout_s, metadata=self._connection.metadata)
        try:
            yield from call
        except grpc.RpcError as error:
            raise self._error(error, method, timeout_s or 0.0) from None
        finally:
            call.cancel()

    def pages(self, method: str, request: Any, response: Any, field: str) -> Iterator[Any]:
        """The items of all pages of a list."""
        while True:
            page = self.call(method, request, response, again=True)
            yield from getattr(page, field)
            if not page.next_page_token:
                return
            request.page_token = page.next_page_token

    def _stub(self, kind: str, method: str, response: Any) -> Any:
        stub = self._methods.get(method)
        if stub is None:
            stub = getattr(self._connection.channel, kind)(
                f"/tactus.v1.{method}", request_serializer=lambda r: r.SerializeToString(),
                response_deserializer=response.FromString)
            self._methods[method] = stub
        return stub

    def _error(self, error: grpc.RpcError, method: str, timeout: float) -> Error:
        made = from_rpc(error)
        if made.code == "DEADLINE_EXCEEDED" and not made.reason:
            return no_response(method.partition("/")[2], timeout)
        return made


def repeated(call: Callable[[], T]) -> T:
    """Repeats a call that has the same effect however often it arrives."""
    wait = 0.025
    for attempt in range(_RETRIES + 1):
        try:
            return call()
        except Error as error:
            if attempt == _RETRIES or not may_retry(error):
                raise
        time.sleep(wait)
        wait = min(2 * wait, 5.0)
    raise AssertionError
