"""Tactus: what a robot's skin touches."""

from tactus._answers import Answer, Contact, Event
from tactus._client import Client
from tactus._errors import Error, FrameError, JobError
from tactus._skin import LightTouch, Skin

__all__ = ["Answer", "Client", "Contact", "Error", "Event", "FrameError", "JobError",
           "LightTouch", "Skin"]
