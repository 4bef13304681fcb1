"""Tactus: what a robot's skin touches.

    >>> import tactus
    >>> skin = tactus.Skin(name="cody-forearm", scale=0.001)  # millinewtons
    >>> skin.shape
    (16, 24)

A server answers frame by frame::

    with tactus.Client("127.0.0.1:50051") as client, client.stream(skin) as stream:
        for answer in stream.push(frame):
            print(answer.main)

docs/python.md begins with the installation and ends with a model of your own.
"""

from tactus._answers import (Answer, Contact, DecidedValue, Event, Notice, Patch, Point,
                             QuestionAnswer, QuestionInfo, Spot, StreamInfo, TouchedObject)
from tactus._async import Answers, AsyncStream
from tactus._calibration import Calibration
from tactus._client import Client, StreamContext
from tactus._contacts import ContactLabel, LoggedAnswer, LoggedContact, Replay
from tactus._datasets import Dataset, DatasetVersion, TrialInfo, TrialNote, Upload
from tactus._errors import Error, FrameError, JobError
from tactus._estimator import TouchClassifier
from tactus._files import Recording, write_trials
from tactus._jobs import (Accuracy, Evaluation, Job, LearningPoint, QuestionReport,
                          ReliabilityBin, Result)
from tactus._local import Classifier
from tactus._models import Alias, AliasChange, Gate, ModelVersion
from tactus._options import StreamOptions
from tactus._skin import PRESETS, LightTouch, Skin
from tactus._stream import Stream, StreamStatistics
from tactus._trials import Touch, Trial

__version__ = "0.1.0"

__all__ = [
    "Accuracy", "Alias", "AliasChange", "Answer", "Answers", "AsyncStream", "Calibration",
    "Classifier", "Client", "Contact", "ContactLabel", "Dataset", "DatasetVersion", "DecidedValue", "Error",
    "Evaluation", "Event", "FrameError", "Gate", "Job", "JobError", "LearningPoint",
    "LightTouch", "LoggedAnswer", "LoggedContact", "ModelVersion", "Notice", "PRESETS", "Patch",
    "Point", "QuestionAnswer", "QuestionInfo", "QuestionReport", "Recording", "ReliabilityBin",
    "Replay", "Result", "Skin", "Spot", "Stream", "StreamContext", "StreamInfo",
    "StreamOptions", "StreamStatistics", "Touch", "TouchClassifier", "TouchedObject", "Trial",
    "TrialInfo", "TrialNote", "Upload", "write_trials",
]
