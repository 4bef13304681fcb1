"""Frames as the bytes of a request.

A request is written around the frame's buffer, without a message object: the
taxels are copied once, into the bytes that grpc sends.
"""

from __future__ import annotations

from struct import Struct
from typing import Any, List, Optional, Sequence, Tuple

import numpy

from tactus._errors import Error, FrameError, invalid
from tactus._skin import Skin

MAX_FRAMES_PER_MESSAGE = 64
MAX_MESSAGE_BYTES = 64 * 1024
# What a message has besides its frames, at the most.
_OVERHEAD_BYTES = 256
_MAX_UINT64 = 2**64 - 1

_POSE = Struct("<7d")
# Six bytes for the sequence number, a tag, and ten for the time.
_HEAD_BYTES = 17

# ClassifyContactRequest.end_of_trial, empty.
END_OF_TRIAL = b"\x1a\x00"


class Message:
    """A request with frames, and what a history knows of it."""

    __slots__ = ("request", "first_sequence", "frames", "first_time_ns", "offset", "last",
                 "frames_before", "missing", "may_begin")

    def __init__(self, request: bytes, first_sequence: int, frames: int, first_time_ns: int,
                 offset: int) -> None:
        self.request = request
        self.first_sequence = first_sequence
        self.frames = frames
        self.first_time_ns = first_time_ns
        #: Where the taxels of the first frame begin in ``request``.
        self.offset = offset
        #: Sequence number of the last frame.
        self.last = first_sequence + frames - 1
        #: Frames of the trial before it, and frames missing until it.
        self.frames_before = 0
        self.missing = 0
        #: A replay may begin with it, as far as poses and cadence are concerned.
        self.may_begin = True


def varint(value: int) -> bytes:
    """A number as protobuf writes it."""
    out = bytearray()
    while value > 127:
        out.append(value & 127 | 128)
        value >>= 7
    out.append(value)
    return bytes(out)


def check_frames_per_message(frames: int) -> None:
    if not 1 <= frames <= MAX_FRAMES_PER_MESSAGE:
        raise invalid("frames_per_message", frames, f"1 to {MAX_FRAMES_PER_MESSAGE}")


class FrameWriter:
    """Packs the frames of one stream into requests."""

    def __init__(self, skin: Skin, frames_per_message: int = 1) -> None:
        check_frames_per_message(frames_per_message)
        self.skin = skin
        self.period_ns = 1e9 / skin.rate_hz
        self._period_ns = round(self.period_ns)
        self._with_poses = skin.with_poses
        self._dtype = numpy.dtype(skin.dtype).newbyteorder("<")
        self._shape = skin.shape
        values = skin.rows * skin.columns * skin.axes
        self._flat = (values,)
        self._bytes = values * self._dtype.itemsize
        room = (MAX_MESSAGE_BYTES - _OVERHEAD_BYTES) // (
            self._bytes + (_POSE.size if skin.with_poses else 0))
        self._most = max(1, min(frames_per_message, room))
        # What is the same in all messages with one frame: before the sequence
        # number, before the taxels, and before the pose.
        self._one = b"\x18\x01\x22" + varint(self._bytes)
        self._tail = b"\x32" + varint(_POSE.size)
        size = 1 + _HEAD_BYTES + len(self._one) + self._bytes
        if skin.with_poses:
            size += len(self._tail) + _POSE.size
        self._start = b"\x12" + varint(size) + b"\x08"
        self._offset = len(self._start) + _HEAD_BYTES + len(self._one)
        self.next_sequence = 1
        self._next_time_ns = 0
        self._pending: List[Any] = []
        self._poses: List[bytes] = []
        self._first_sequence = 0
        self._first_time_ns = 0

    @property
    def pending(self) -> int:
        """Frames that wait for a message to be full."""
        return len(self._pending)

    def check(self, frame: Any) -> None:
        """Raises a FrameError unless ``frame`` is one of this skin."""
        shape = " x ".join(str(side) for side in self._shape)
        right = f"a C-contiguous numpy array of {self.skin.dtype} and of shape {self._shape}"
        if not isinstance(frame, numpy.ndarray):
            raise _wrong("frame", f"a {type(frame).__name__}", right,
                         f"numpy.asarray(frame, numpy.{self.skin.dtype})")
        if frame.shape != self._shape and frame.shape != self._flat:
            raise FrameError(
                f"frame.shape is {frame.shape}; it must be {self._shape}, as the skin "
                f"{self.skin.name} has {shape} values", reason="FRAME_SIZE_MISMATCH",
                metadata={"field": "frame.shape", "value": str(frame.shape),
                          "expected": str(self._shape)})
        if frame.dtype != self._dtype:
            raise _wrong("frame.dtype", frame.dtype.str if frame.dtype.name == self.skin.dtype
                         else frame.dtype.name,
                         f"{self.skin.dtype}, as skin.dtype says",
                         f"frame.astype(numpy.{self.skin.dtype}), or another dtype in the Skin")
        if not frame.flags.c_contiguous:
            raise _wrong("frame", f"not contiguous (strides {frame.strides})", right,
                         "numpy.ascontiguousarray(frame)")

    def add(self, frame: Any, time_ns: Optional[int], missing: int,
            pose: Optional[Sequence[float]]) -> Tuple[Message, ...]:
        """Takes a frame; returns the messages that are full now."""
        if (type(frame) is not numpy.ndarray or frame.dtype != self._dtype
                or frame.shape != self._shape or not frame.flags.c_contiguous):
            self.check(frame)
        if missing:
            if missing < 0:
                raise invalid("missing_before", missing, "0 or more")
            self._next_time_ns += round(missing * self.period_ns)
        if pose is not None or self._with_poses:
            self._add_pose(pose)
        if time_ns is None:
            time_ns = self._next_time_ns
        self._next_time_ns = time_ns + self._period_ns
        n = self.next_sequence + missing
        self.next_sequence = n + 1
        if self._most == 1:
            t = time_ns & _MAX_UINT64
            # Varints of a fixed length, longer than need be: then the sizes
            # before them are constant.
            head = bytes((
                n & 127 | 128, n >> 7 & 127 | 128, n >> 14 & 127 | 128, n >> 21 & 127 | 128,
                n >> 28 & 127 | 128, n >> 35 & 127, 16, t & 127 | 128, t >> 7 & 127 | 128,
                t >> 14 & 127 | 128, t >> 21 & 127 | 128, t >> 28 & 127 | 128,
                t >> 35 & 127 | 128, t >> 42 & 127 | 128, t >> 49 & 127 | 128,
                t >> 56 & 127 | 128, t >> 63))
            if self._with_poses:
                request = b"".join((self._start, head, self._one, frame, self._tail,
                                    self._poses.pop()))
            else:
                request = b"".join((self._start, head, self._one, frame))
            return (Message(request, n, 1, time_ns, self._offset),)
        done: Tuple[Message, ...] = ()
        if missing and self._pending:
            # The pose of this frame belongs to the next message.
            pose_bytes = self._poses.pop() if self._poses else None
            done = (self._message(),)
            if pose_bytes is not None:
                self._poses.append(pose_bytes)
        if not self._pending:
            self._first_sequence = n
            self._first_time_ns = time_ns
        # A copy, because the robot writes to its frame again.
        self._pending.append(frame.tobytes())
        if len(self._pending) == self._most:
            done += (self._message(),)
        return done

    def flush(self) -> Tuple[Message, ...]:
        """Returns the message that is not full, if there is one."""
        return (self._message(),) if self._pending else ()

    def _add_pose(self, pose: Optional[Sequence[float]]) -> None:
        if not self._with_poses:
            raise FrameError("a pose was given, but the skin has none", reason="INVALID_POSE",
                             advice="use Skin(with_poses=True), or leave the pose out")
        if pose is None or len(pose) != 7:
            raise FrameError(
                f"pose has {0 if pose is None else len(pose)} numbers; it must have 7: x, y and z "
                "in metres and the unit quaternion qx, qy, qz, qw", reason="INVALID_POSE")
        self._poses.append(_POSE.pack(*pose))

    def _message(self) -> Message:
        frames = len(self._pending)
        head = b"".join((
            b"\x08", varint(self._first_sequence), b"\x10",
            varint(self._first_time_ns & _MAX_UINT64), b"\x18", varint(frames), b"\x22",
            varint(frames * self._bytes)))
        tail = b""
        if self._poses:
            poses = b"".join(self._poses)
            tail = b"\x32" + varint(len(poses)) + poses
            self._poses = []
        start = b"\x12" + varint(len(head) + frames * self._bytes + len(tail))
        request = b"".join((start, head, *self._pending, tail))
        self._pending = []
        return Message(request, self._first_sequence, frames, self._first_time_ns,
                       len(start) + len(head))


def _wrong(field: str, value: str, expected: str, advice: str) -> Error:
    return FrameError(f"{field} is {value}; it must be {expected}", reason="INVALID_CONFIG",
                      metadata={"field": field, "value": value, "expected": expected},
                      advice=advice)
