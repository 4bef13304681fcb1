"""What a stream keeps to go on after a lost connection as if nothing happened.

The rules are those of the C++ client (client/stream/stream_history.h): the
messages since the beginning of the trial are kept; those before the last frame
without a contact are dropped where no bit of an answer depends on them. A new
stream gets the kept messages again, and its answers are made those of one
stream: ids of contacts, frames_missing and superseded count on.
"""

from __future__ import annotations

from collections import deque
from typing import Any, Deque, Optional, Tuple

from tactus._frames import Message
from tactus.v1 import contact_pb2

_RELEASED = 4
MIN_REPLAY_BYTES = 256 * 1024
MAX_REPLAY_BYTES = 16 * 1024 * 1024
# What a message takes besides its bytes.
_RECORD_BYTES = 200


class PoseSpacing:
    """Which poses a server keeps for the estimate at onset."""

    def __init__(self, rate_hz: float) -> None:
        self._spacing = max(1, int(0.01 * rate_hz + 0.5))
        self.window = max(1, int(0.2 * rate_hz + 0.5))
        self.reset()

    def reset(self) -> None:
        self._frame = 0
        self._kept: Optional[int] = None

    def step(self, missing: int) -> bool:
        """Takes the next frame; True if its pose is kept."""
        if missing >= self.window:
            self.reset()
        self._frame += min(missing, self.window) + 1
        if self._kept is not None and self._frame - self._kept < self._spacing:
            return False
        self._kept = self._frame
        return True


class StreamHistory:
    """Belongs to one thread, or is guarded by its stream's lock."""

    def __init__(self, *, light_touch: bool, interval: int, with_poses: bool, rate_hz: float,
                 max_bytes: int) -> None:
        self._every_frame_matters = light_touch
        self._interval = interval
        self._spacing = PoseSpacing(rate_hz) if with_poses else None
        # Frames before an onset that belong to it.
        self._lead = self._spacing.window if self._spacing else 0
        self._period_ns = 1e9 / rate_hz
        self._max_bytes = max_bytes

        self._ring: Deque[Message] = deque()
        self.bytes = 0
        # Messages of the ring that the current stream has got.
        self._next = 0
        self.last_sequence = 0
        self._last_message: Optional[Message] = None
        self._sent = 0
        self.replayed_frames = 0
        self.trial_frames = 0
        self._missing = 0
        #: The trial will get no more frames, and its final has not come.
        self.ending = False
        self._beginning_lost = False

        #: Sequence numbers of the last frame in an answer that was returned,
        #: and in one of this stream.
        self.delivered = 0
        self.answered = 0
        self._superseded = 0
        self._contacts = 0
        self._touched = False
        self._touched_from = 0
        self._contacts_until_touched = 0
        self._idle_from = 0
        self._idle_to = 0
        # The contact that ended last: it, its onset time, its scores.
        self._last_end: Optional[Tuple[Any, int, Any]] = None
        self._contacts_before = 0
        self._end_before: Optional[Tuple[Any, int, Any]] = None

        self._resumed = False
        self._base_contacts = 0
        self._base_missing = 0
        self._base_superseded = 0
        self._repeated_superseded = 0
        self._base_end: Optional[Tuple[Any, int, Any]] = None

    def add(self, message: Message, sent: bool = False) -> bool:
        """Appends a message, which is sent now or later. False if there is no
        room for it: then only messages are left that were never sent."""
        size = len(message.request) + _RECORD_BYTES
        while self.bytes + size > self._max_bytes:
            if not self._ring or self._ring[0].last > self._sent:
                return False
            self._beginning_lost = True
            self._pop()
        lost = 0
        frames = self.trial_frames
        if frames == 0:
            self._idle_from = message.first_sequence
        else:
            lost = message.first_sequence - self.last_sequence - 1
            self._missing += lost
        message.frames_before = frames
        message.missing = self._missing
        if self._interval != 1:
            message.may_begin = frames % self._interval == 0
        if self._spacing is not None:
            for i in range(message.frames):
                kept = self._spacing.step(lost if i == 0 else 0)
                if i == 0 and not kept:
                    message.may_begin = False
        self._ring.append(message)
        self.bytes += size
        self.trial_frames = frames + message.frames
        self.last_sequence = message.last
        self._last_message = message
        if sent:
            self._next = len(self._ring)
            self._sent = message.last
        return True

    def end_trial(self) -> None:
        self.ending = True

    @property
    def has_unsent(self) -> bool:
        return self._next < len(self._ring)

    def next_unsent(self) -> Optional[Message]:
        """The next message that the current stream has not got; it counts as
        sent."""
        if not self.has_unsent:
            return None
        record = self._ring[self._next]
        if record.last <= self._sent:
            self.replayed_frames += record.frames
        else:
            self._sent = record.last
        self._next += 1
        return record

    def begin_stream(self) -> bool:
        """A new stream begins: all that is kept is unsent. False if frames that
        it needs were dropped."""
        lost = self._beginning_lost and bool(self._ring)
        self._resumed = True
        self._next = 0
        self.answered = 0
        self._base_superseded = self._superseded
        self._repeated_superseded = 0
        self._base_missing = self._ring[0].missing if self._ring else self._missing
        if not lost:
            self._base_contacts = self._contacts_before
            self._base_end = self._end_before
            return True
        self._base_contacts = self._contacts
        self._base_end = None if self._touched else self._last_end
        return False

    def take(self, answer: Any) -> Any:
        """Takes an answer of the current stream. Returns the one for the robot,
        or None if it has had it or must not get it."""
        sequence = answer.sequence
        if sequence > self.answered:
            self.answered = sequence
        final = answer.is_final
        if not final:
            if sequence <= self.delivered:
                self._repeated_superseded = answer.superseded
                return None
        elif not self.ending or not (self.trial_frames == 0 or sequence == self.last_sequence):
            # A server that drains ends a trial that the robot has not ended.
            return None
        if self._resumed:
            answer = self._rebase(answer)
        self._superseded = answer.superseded
        if final:
            self._finish_trial()
            return answer
        self.delivered = sequence
        contacts = answer.contacts
        if self._touched and contacts:
            # Mostly, the same contacts as before go on.
            for contact in contacts:
                if contact.state == _RELEASED or contact.id > self._contacts:
                    break
            else:
                return answer
        if contacts or self._touched:
            self._learn(answer, contacts)
        if self._touched:
            self._drop_before(self._touched_from, self._contacts_until_touched)
        elif not contacts:
            self._drop_before(sequence + 1, self._contacts)
        return answer

    def find(self, sequence: int) -> Optional[Message]:
        """The message with a frame, if it is kept."""
        for message in reversed(self._ring):
            if message.first_sequence <= sequence:
                return message if sequence <= message.last else None
        return None

    def _last_time_ns(self) -> int:
        message = self._last_message
        if message is None:
            return 0
        return message.first_time_ns + round((message.frames - 1) * self._period_ns)

    def _pop(self) -> None:
        self.bytes -= len(self._ring.popleft().request) + _RECORD_BYTES
        if self._next:
            self._next -= 1

    def _rebase(self, answer: Any) -> Any:
        shown = contact_pb2.Answer()
        shown.CopyFrom(answer)
        if shown.is_final and self.trial_frames == 0:
            # In a trial without frames, a final repeats the last frame before it.
            shown.sequence = self.last_sequence
            shown.capture_time_ns = self._last_time_ns()
        base = self._base_contacts
        if base:
            for contact in shown.contacts:
                for name in ("id", "parent_id", "merged_into"):
                    number = getattr(contact, name)
                    if number:
                        setattr(contact, name, number + base)
            for event in shown.events:
                for name in ("contact_id", "other_id"):
                    number = getattr(event, name)
                    if number:
                        setattr(event, name, number + base)
        if shown.is_final and not shown.contacts and self._base_end is not None:
            ended, onset_ns, scores = self._base_end
            contact = shown.contacts.add()
            contact.CopyFrom(ended)
            contact.time_since_onset_ns = shown.capture_time_ns - onset_ns
            if scores is not None:
                shown.diagnostics.contacts.add().CopyFrom(scores)
        shown.frames_missing += self._base_missing
        shown.superseded = self._base_superseded + answer.superseded - min(
            self._repeated_superseded, answer.superseded)
        return shown

    def _learn(self, answer: Any, contacts: Any) -> None:
        first_onset = answer.sequence + 1
        first_id = 0
        for i, contact in enumerate(contacts):
            number = contact.id
            if number > self._contacts:
                self._contacts = number
            if contact.state == _RELEASED:
                ended = contact_pb2.Contact()
                ended.CopyFrom(contact)
                scores = None
                if len(answer.diagnostics.contacts) > i:
                    scores = contact_pb2.ContactScores()
                    scores.CopyFrom(answer.diagnostics.contacts[i])
                self._last_end = (ended, answer.capture_time_ns - contact.time_since_onset_ns,
                                  scores)
                continue
            onset = contact.onset_sequence
            if onset < first_onset:
                first_onset = onset
            if first_id == 0 or number < first_id:
                first_id = number
        if first_id and not self._touched:
            self._touched_from = first_onset
            self._contacts_until_touched = first_id - 1
        self._touched = first_id != 0
        if not self._touched and contacts:
            self._idle_from = answer.sequence + 1

    def _drop_before(self, idle_to: int, contacts: int) -> None:
        """Drops the messages before the last one that a replay may begin with,
        given that no contact touched the frames before ``idle_to``."""
        if self._every_frame_matters or idle_to == self._idle_to:
            return
        self._idle_to = idle_to
        first = -1
        for i in range(self._next):
            record = self._ring[i]
            begin = record.first_sequence
            if begin + self._lead > idle_to:
                break
            if record.may_begin and begin >= self._idle_from:
                first = i
        if first < 0:
            return
        for _ in range(first):
            self._pop()
        self._beginning_lost = False
        self._contacts_before = contacts
        self._end_before = self._last_end

    def _finish_trial(self) -> None:
        self._ring.clear()
        self.bytes = 0
        self._next = 0
        if self._spacing is not None:
            self._spacing.reset()
        self.trial_frames = 0
        self._missing = 0
        self.ending = False
        self._beginning_lost = False
        self._touched = False
        self._last_end = None
        self._end_before = None
        self._contacts_before = self._contacts
        self._base_missing = 0
        self._base_end = None
