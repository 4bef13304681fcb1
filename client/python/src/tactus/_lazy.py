"""Dataclasses that read their fields from a message when somebody asks.

A robot asks for few of an answer's hundred numbers, so making all of them would
cost more than receiving them. A field that was read stays; equality, repr and
pickle read all of them.
"""

from __future__ import annotations

from dataclasses import fields
from typing import TYPE_CHECKING, Any, Callable, ClassVar, Dict


class Lazy:
    """Base of a frozen dataclass whose fields have no default values."""

    # Name of a field to a function of what __dict__ has: the message, and what
    # its indices stand for.
    _decoders: ClassVar[Dict[str, Callable[[Dict[str, Any]], Any]]] = {}

    if not TYPE_CHECKING:

        @classmethod
        def _of(cls, message, names):
            made = object.__new__(cls)
            made.__dict__.update(_message=message, _names=names)
            return made

        # Only called for what __dict__ does not have.
        def __getattr__(self, name):
            values = self.__dict__
            decode = self._decoders.get(name)
            if decode is None or "_message" not in values:
                raise AttributeError(f"{type(self).__name__} has no {name}")
            value = values[name] = decode(values)
            return value

        def __getstate__(self):
            return {field.name: getattr(self, field.name) for field in fields(self)}

        def __setstate__(self, state):
            self.__dict__.update(state)
