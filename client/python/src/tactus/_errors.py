"""Errors: what was wrong, its value, what would be right, and a stable reason."""

from __future__ import annotations

from typing import Any, Mapping, Optional

import grpc

from tactus.v1 import common_pb2

# The key in which a server sends its error whole.
_DETAILS = "grpc-status-details-bin"
_ERROR_INFO = "type.googleapis.com/google.rpc.ErrorInfo"

# What to do about an error that no server explains in its details.
_ADVICE = {
    "MODEL_NOT_FOUND": "name a model that the server has (client.models()), or train one",
    "GEOMETRY_MISMATCH": "use the skin that the model was trained on, or train a model for this skin",
    "UNKNOWN_LAYOUT": "describe the skin in full: rows, columns, pitches, thresholds",
    "STREAM_FINISHED": "open a new stream",
    "STREAM_IDLE": "send frames also while nothing touches",
    "STREAM_LIMIT": "end other streams, or try again later",
    "DRAINING": "the server shuts down; use another, or try again later",
    "NO_RESPONSE": "see whether the server runs; the next stream may work",
    "UNAUTHENTICATED": "give the token that the server knows you by: token_file= or TACTUS_TOKEN_FILE",
    "PERMISSION_DENIED": "ask for a token with a role that may do this",
    "NO_DATA_DIRECTORY": "start the server with --data-dir=FOLDER",
    "NO_CONTACT_LOG": "start the server with --keep-contacts=1G and --data-dir",
    "DATASET_NOT_FOUND": "see client.datasets() for those that there are",
    "DATASET_EXISTS": "use client.dataset(name) for the one that is there",
    "ETAG_MISMATCH": "read the alias again, then repeat the change",
    "GATE_NOT_PASSED": "train a better model, or promote with force=True",
    "JOB_LIMIT": "wait until a job has ended",
    "QUOTA_EXCEEDED": "delete what is not needed any more",
    "STORAGE_FULL": "delete datasets or models, or give the server more room",
    "OFFSET_MISMATCH": "upload again: it continues where the server stands",
    "TIME_REGRESSION": "give each frame a later capture_time_ns than the one before, in nanoseconds",
    "NEGATIVE_TAXEL": "set signed_values=True in the skin, or take the offset away",
    "NON_FINITE_TAXEL": "mask dead taxels: Skin(masked_taxels=...)",
}


class Error(Exception):
    """An error of Tactus.

    Programs react to ``reason``, which never changes, not to the text.

    >>> error = Error("rows is 0; it must be 1 to 64", reason="INVALID_CONFIG",
    ...               metadata={"field": "rows", "expected": "1 to 64"})
    >>> error.reason, error.advice
    ('INVALID_CONFIG', 'rows must be 1 to 64')
    """

    def __init__(
        self,
        message: str,
        *,
        reason: str = "",
        code: str = "INVALID_ARGUMENT",
        metadata: Optional[Mapping[str, str]] = None,
        advice: str = "",
    ) -> None:
        super().__init__(message)
        #: The text for people, without the reason.
        self.message = message
        #: Name of a ``tactus.v1.ErrorReason`` without its prefix; empty if it
        #: is no error of Tactus, such as a server that cannot be reached.
        self.reason = reason
        #: Name of the gRPC status code, such as "NOT_FOUND".
        self.code = code
        #: What was wrong, its value and what is right, for programs.
        self.metadata = dict(metadata or {})
        self._advice = advice

    @property
    def advice(self) -> str:
        """What to do about it, as one sentence; empty if nothing is known."""
        if self._advice:
            return self._advice
        if "field" in self.metadata and "expected" in self.metadata:
            return f"{self.metadata['field']} must be {self.metadata['expected']}"
        return _ADVICE.get(self.reason, "")

    def __str__(self) -> str:
        text = self.message
        if self._advice and self._advice not in text:
            text += f": {self._advice}"
        return f"{text} [{self.reason}]" if self.reason else text

    def __reduce__(self) -> Any:
        return (_restore, (type(self), self.message, self.reason, self.code,
                           self.metadata, self._advice))


class FrameError(Error, ValueError):
    """A frame that the skin cannot have: its type, its shape, its order."""


class JobError(Error):
    """A job that failed, or was cancelled; ``reason`` is that of its error."""


def _restore(kind: Any, message: str, reason: str, code: str,
             metadata: Mapping[str, str], advice: str) -> Error:
    error: Error = kind(message, reason=reason, code=code, metadata=metadata,
                        advice=advice)
    return error


def invalid(field: str, value: object, expected: str,
            reason: str = "INVALID_CONFIG") -> Error:
    """The error that the C++ client makes of a value that is out of range."""
    return Error(f"{field} is {value}; it must be {expected}", reason=reason,
                 metadata={"field": field, "value": str(value), "expected": expected})


def no_response(what: str, seconds: float) -> Error:
    return Error(f"the server did not respond to {what} within {seconds:g} s",
                 reason="NO_RESPONSE", code="DEADLINE_EXCEEDED")


def stream_finished() -> Error:
    return Error("the stream has ended", reason="STREAM_FINISHED",
                 code="FAILED_PRECONDITION")


def from_status(code: int, message: str, details: bytes) -> Error:
    """The error of a call. ``details`` is a serialised ``tactus.v1.Status``."""
    status = common_pb2.Status()
    try:
        status.ParseFromString(details)
    except Exception:  # Each implementation of protobuf raises another one.
        status.Clear()
    info = common_pb2.ErrorInfo()
    for detail in status.details:
        if detail.type_url == _ERROR_INFO:
            info.ParseFromString(detail.value)
    return Error(message, reason=info.reason, code=code_name(code),
                 metadata=dict(info.metadata), advice=_connection_advice(code, message, info.reason))


def from_message(status: Any) -> Error:
    """The error in a message, such as that of a job."""
    return from_status(status.code, status.message, status.SerializeToString())


def from_rpc(error: grpc.RpcError) -> Error:
    """The error behind what grpc raises."""
    details = b""
    for key, value in error.trailing_metadata() or ():
        if key == _DETAILS:
            details = value
    return from_status(error.code().value[0], error.details() or "", details)


def details_of(metadata: Any) -> bytes:
    """The serialised Status in the trailing metadata of a call."""
    for item in metadata or ():
        if item[0] == _DETAILS:
            value: bytes = item[1]
            return value
    return b""


_CODES = {code.value[0]: code.name for code in grpc.StatusCode}


def code_name(code: int) -> str:
    return _CODES.get(code, "UNKNOWN")


def may_retry(error: Error) -> bool:
    """True if the same call may succeed later: it broke on its way."""
    if error.code == "UNAVAILABLE":
        return True
    if error.code == "ABORTED":
        return error.reason == "UPLOAD_BUSY"
    if error.code == "DEADLINE_EXCEEDED":
        return error.reason in ("", "NO_RESPONSE")
    # grpc reports broken connections and streams with these.
    return error.code in ("CANCELLED", "INTERNAL", "UNKNOWN") and not error.reason


def _connection_advice(code: int, message: str, reason: str) -> str:
    if code != grpc.StatusCode.UNAVAILABLE.value[0] or reason:
        return ""
    text = message.lower()
    if "certificate" in text or "ssl" in text:
        return ("the TLS connection failed; give the certificate of the authority that signed "
                "the server's with tls_ca=, and address the server by a name that it has")
    if "socket closed" in text or "connection reset" in text:
        return ("the server closed the connection; if it uses TLS, give the certificate of its "
                "authority with tls_ca=")
    return "no server answered; start one with tactusd, or give the address of another"
