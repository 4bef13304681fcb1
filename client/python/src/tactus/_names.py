"""Names of resources, short or in full, and ids of requests."""

from __future__ import annotations

import datetime
import uuid


def full_name(collection: str, text: str) -> str:
    """The full name of a resource.

    >>> full_name("models", "arm@3"), full_name("datasets", "datasets/arm")
    ('models/arm/versions/3', 'datasets/arm')
    """
    name = str(text).replace("@", "/versions/")
    return name if name.startswith(f"{collection}/") else f"{collection}/{name}"


def version_name(text: str) -> str:
    """A model's or an alias' full name: a stream takes both in short."""
    return text if text.startswith("aliases/") else full_name("models", text)


def new_request_id() -> str:
    return f"python-{uuid.uuid4().hex}"


def time_of(ms: int) -> datetime.datetime:
    """Milliseconds since 1970 as a time with its zone, UTC."""
    return datetime.datetime.fromtimestamp(ms / 1000, datetime.timezone.utc)
