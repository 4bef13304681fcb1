"""What a caller may choose of a stream."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Optional

from tactus._errors import invalid
from tactus._skin import TAXEL_TYPES, Skin, to_geometry
from tactus.v1 import contact_pb2

CADENCES = {"interval": 1, "on_change": 3, "events": 4}


@dataclass(frozen=True)
class StreamOptions:
    """Options of a stream; ``Client.stream`` takes them as keyword arguments.

    Answers with events, and finals, come whatever the cadence is.
    """

    #: "M", "M@V" or the name of an alias; empty: the served model that fits the
    #: skin ("default" if it fits, else the first by name).
    model: str = ""
    #: Names the robot in the server's logs; at most 128 bytes.
    client_id: str = ""
    #: Which answers come: "interval", after every ``interval_frames``-th frame;
    #: "on_change", when the number of contacts, or what they probably are,
    #: changes; "events", no others.
    cadence: str = "interval"
    interval_frames: int = 1
    #: Frames that travel in one message, 1 to 64. More cost less and answer
    #: later.
    frames_per_message: int = 1
    #: What decides a question; None: what the model was calibrated to.
    decision_threshold: Optional[float] = None
    decision_frames: Optional[int] = None
    #: A contact ends at the latest this many seconds after its last touch; None:
    #: the model's own.
    release_after_s: Optional[float] = None
    #: Only end_trial ends a contact.
    never_release: bool = False
    #: Contacts that are followed at the same time, 1 to 8; None: 8, or 1 for
    #: models of the whole skin.
    max_contacts: Optional[int] = None
    #: About half of the computing time: less accurate, no Contact.object.
    low_effort: bool = False
    #: Fill in Patch.taxels.
    with_taxels: bool = False
    #: True: push waits for the answer to its frame, if one is due and the
    #: connection stands. False: push only sends; the answers that have come are
    #: returned by the next calls, and a thread receives them.
    wait: bool = True


def to_config(skin: Skin, options: StreamOptions) -> Any:
    """The ``tactus.v1.StreamConfig`` of a stream."""
    # The enumerations are numbers here, and types in the stubs.
    config: Any = contact_pb2.StreamConfig()
    config.geometry.CopyFrom(to_geometry(skin))
    config.taxel_type = TAXEL_TYPES[skin.dtype]
    config.scale = skin.scale
    config.sample_rate_hz = skin.rate_hz
    config.with_poses = skin.with_poses
    config.model = options.model
    config.client_id = options.client_id
    if options.cadence not in CADENCES:
        raise invalid("cadence", options.cadence, "interval, on_change or events")
    interval = _count("interval_frames", options.interval_frames)
    config.cadence = CADENCES[options.cadence]
    if options.cadence == "interval" and interval != 1:
        config.cadence = contact_pb2.RESULT_CADENCE_EVERY_N_FRAMES
        config.result_interval_frames = interval
    if options.decision_threshold is not None:
        config.decision_threshold = options.decision_threshold
    if options.decision_frames is not None:
        config.decision_frames = _count("decision_frames", options.decision_frames)
    if options.release_after_s is not None:
        config.release_after_ms = _count("release_after_s", round(options.release_after_s * 1000))
    config.never_release = options.never_release
    if options.max_contacts is not None:
        config.max_contacts = _count("max_contacts", options.max_contacts)
    config.effort = contact_pb2.EFFORT_LOW if options.low_effort else contact_pb2.EFFORT_FULL
    config.with_taxels = options.with_taxels
    return config


def _count(field: str, value: int) -> int:
    if not 0 <= value < 2**32:
        raise invalid(field, value, "0 or more")
    return value
