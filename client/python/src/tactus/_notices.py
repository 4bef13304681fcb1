"""Notices of a stream as text, in the words of the C++ client."""

from __future__ import annotations

from typing import Any, Optional

from tactus._answers import Notice


def notice_of(message: Any) -> Optional[Notice]:
    """The Notice of a ``tactus.v1.StreamNotice``; None if its kind has no name
    here."""
    if message.kind == 1:
        return Notice("draining", f"the server shuts down within {message.grace_ms} ms")
    if message.kind == 2:
        return Notice("model superseded", "the server has a newer version of the model")
    if message.kind == 3:
        return Notice("rate differs",
                      f"frames come at {message.measured_rate_hz:g} Hz by their capture times, "
                      f"not at {message.stated_rate_hz:g}")
    if message.kind == 4:
        some = "; ".join(
            f"taxel {taxel.taxel} reads {taxel.load:g}, in training "
            f"{taxel.least_trained:g} to {taxel.most_trained:g}" for taxel in message.taxels)
        return Notice("skin differs",
                      f"{message.differing_taxels} taxels read unlike in training: {some}")
    return None
