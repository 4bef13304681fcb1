"""Jobs of the training service: trainings, evaluations, promotions."""

from __future__ import annotations

import datetime
import time
from dataclasses import dataclass
from typing import Any, Iterable, Iterator, Mapping, Optional, Tuple

from tactus._connection import Api
from tactus._errors import Error, JobError, from_message, may_retry
from tactus._names import time_of
from tactus._progress import Bar
from tactus.v1 import operations_pb2 as pb

STATES = {1: "queued", 2: "running", 3: "cancelling", 4: "succeeded", 5: "failed",
          6: "cancelled"}
_ENDED = ("succeeded", "failed", "cancelled")
_RETRIES = 10


@dataclass(frozen=True)
class Accuracy:
    """An accuracy with its denominator and 95 % Wilson interval."""

    correct: int
    contacts: int
    low: float
    high: float

    @property
    def value(self) -> float:
        """correct / contacts; NaN without contacts."""
        return self.correct / self.contacts if self.contacts else float("nan")

    def __str__(self) -> str:
        return (f"{self.correct} of {self.contacts} ({self.value:.1%}, "
                f"95 % {self.low:.1%} to {self.high:.1%})")


@dataclass(frozen=True)
class QuestionReport:
    """Measured figures of the answers to one question."""

    #: At the end of each contact.
    accuracy: Accuracy
    #: Seconds since onset, and the accuracy at each; the times are those of
    #: ``Evaluation.anytime``. The right value of a state is the one at that time,
    #: if the trial says when the state changed.
    anytime: Mapping[float, Accuracy]


@dataclass(frozen=True)
class ReliabilityBin:
    """Contacts whose most probable class had about the same probability."""

    #: Bounds of this probability, 0 to 1.
    low: float
    high: float
    #: Mean of this probability. Well calibrated is near ``accuracy.value``.
    confidence: float
    #: How many of the contacts were classified as their label says.
    accuracy: Accuracy


@dataclass(frozen=True)
class Evaluation:
    """Measured figures of one model on one dataset version."""

    accuracy: Accuracy
    #: Trials without a contact: the skin never felt them.
    never_felt: int
    #: Mean negative log-probability of the true class, in nats.
    log_loss: float
    #: Expected calibration error, 0 to 1.
    calibration_error: float
    classes: Tuple[str, ...]
    #: Counts: true class (rows) by predicted class (columns).
    confusion: Tuple[Tuple[int, ...], ...]
    #: Seconds since onset, and the accuracy at each.
    anytime: Mapping[float, Accuracy]
    #: True if the model was trained on some of these contacts; None if unknown.
    trained_on_data: Optional[bool]
    #: Contacts that were classified wrongly: name, label, answer; the first 20.
    wrong: Tuple[Tuple[str, str, str], ...]
    #: Per question of the model, by its name. Empty if an earlier release
    #: measured.
    questions: Mapping[str, QuestionReport]
    #: The bins of ``calibration_error`` that hold a contact, by increasing
    #: confidence; at most 15. Empty if an earlier release measured.
    reliability: Tuple[ReliabilityBin, ...]

    def _repr_html_(self) -> str:
        from tactus._svg import evaluation_html

        return evaluation_html(self)


@dataclass(frozen=True)
class LearningPoint:
    """One point of a learning curve."""

    phase: str
    #: Such as "hmm/SU", "lstm/0" or "fold/2/scores".
    part: str
    #: Iteration of Baum-Welch, or epoch; from 1.
    iteration: int
    max_iterations: int
    #: Nats.
    log_likelihood: Optional[float]
    loss: Optional[float]
    accuracy: Optional[float]
    validation_loss: Optional[float]
    validation_accuracy: Optional[float]
    elapsed_s: float


@dataclass(frozen=True)
class Result:
    """What a job made."""

    #: Of training: "models/M/versions/V".
    model_version: str
    #: Of evaluation; of promotion with a gate that of the candidate.
    evaluation: Optional[Evaluation]
    #: Of promotion with a gate: why it was not passed; empty if it was.
    gate_failure: str
    unusable_trials: Tuple[str, ...]
    #: Of training and evaluation, if the preset was chosen.
    preset: str


class Job:
    """A job. ``job.wait()`` returns its result; ``for point in job`` watches it
    learn::

        job = client.train("arm@2", "arm")
        for point in job:
            print(point.part, point.iteration, point.loss)
        print(job.wait().model_version)
    """

    def __init__(self, api: Api, operation: Any) -> None:
        self._api = api
        self._operation = operation

    @property
    def name(self) -> str:
        """"operations/O"."""
        return str(self._operation.name)

    @property
    def kind(self) -> str:
        """"train", "evaluate" or "promote"."""
        return {1: "train", 2: "evaluate", 3: "promote"}.get(self._operation.kind, "")

    @property
    def state(self) -> str:
        """"queued", "running", "cancelling", "succeeded", "failed" or
        "cancelled", as it was known last; ``refresh`` asks the server."""
        return STATES.get(self._operation.state, "queued")

    @property
    def ended(self) -> bool:
        return self.state in _ENDED

    @property
    def phase(self) -> str:
        """What it does at present."""
        return str(self._operation.progress.phase)

    @property
    def fraction(self) -> float:
        """How much of the phase is done, 0 to 1."""
        return float(self._operation.progress.fraction)

    @property
    def created(self) -> datetime.datetime:
        return time_of(self._operation.create_time_ms)

    @property
    def requester(self) -> str:
        return str(self._operation.requester)

    @property
    def error(self) -> Optional[Error]:
        """Why it failed, or that it was cancelled; None otherwise."""
        if self.state == "failed":
            made = from_message(self._operation.error)
        elif self.state == "cancelled":
            made = Error("the job was cancelled", reason="CANCELLED", code="CANCELLED")
        else:
            return None
        return JobError(f"{self.name} {self.state}: {made.message}", reason=made.reason,
                        code=made.code, metadata=made.metadata)

    @property
    def result(self) -> Optional[Result]:
        """What it made, if it has ended well; of a promotion that did not pass
        its gate, the figures."""
        if not self._operation.HasField("result"):
            return None
        return _result_of(self._operation.result)

    def refresh(self) -> "Job":
        """Asks the server how it stands."""
        self._operation = self._api.call(
            "OperationService/GetOperation", pb.GetOperationRequest(name=self.name),
            pb.GetOperationResponse, again=True).operation
        return self

    def wait(self, timeout_s: Optional[float] = None, *, progress: bool = False) -> Result:
        """Waits for the end and returns the result.

        ``progress`` shows a bar: that of tqdm if it is there, else a line for
        each phase. Raises :class:`tactus.JobError` if the job failed or was
        cancelled, and TimeoutError after ``timeout_s`` seconds; the job goes on.
        """
        deadline = None if timeout_s is None else time.monotonic() + timeout_s
        bar = Bar(self.name) if progress else None
        try:
            while not self.ended:
                left = 2.0 if bar is not None else 30.0
                if deadline is not None:
                    left = min(left, deadline - time.monotonic())
                    if left <= 0:
                        raise TimeoutError(f"{self.name} has not ended within {timeout_s:g} s; "
                                           "it goes on")
                self._operation = self._api.call(
                    "OperationService/WaitOperation",
                    pb.WaitOperationRequest(name=self.name, timeout_ms=max(1, int(left * 1000))),
                    pb.WaitOperationResponse, again=True).operation
                if bar is not None:
                    bar.show(self.phase or self.state, self.fraction)
        finally:
            if bar is not None:
                bar.close()
        error = self.error
        if error is not None:
            raise error
        result = self.result
        return result if result is not None else _result_of(pb.OperationResult())

    def __iter__(self) -> Iterator[LearningPoint]:
        return self.points()

    def points(self) -> Iterator[LearningPoint]:
        """The points of the learning curve: those so far, then each new one until
        the job has ended. A watch that breaks goes on."""
        seen = failures = 0
        while True:
            count = 0
            try:
                for message in self._api.receive(
                        "OperationService/WatchOperation", pb.WatchOperationRequest(name=self.name),
                        pb.WatchOperationResponse):
                    self._operation = message.operation
                    for point in message.points:
                        count += 1
                        if count > seen:
                            seen, failures = count, 0
                            yield _point_of(point)
                return
            except Error as error:
                failures += 1
                if failures > _RETRIES or not may_retry(error):
                    raise
            time.sleep(min(0.025 * 2**failures, 5.0))

    def cancel(self) -> None:
        """Asks the job to stop."""
        self._operation = self._api.call(
            "OperationService/CancelOperation", pb.CancelOperationRequest(name=self.name),
            pb.CancelOperationResponse, again=True).operation

    def delete(self) -> None:
        """Deletes a job that has ended; what it made stays."""
        self._api.call("OperationService/DeleteOperation",
                       pb.DeleteOperationRequest(name=self.name), pb.DeleteOperationResponse)

    def log(self) -> str:
        """What the job's processes wrote to their log."""
        parts = self._api.receive("OperationService/ReadOperationLog",
                                  pb.ReadOperationLogRequest(name=self.name),
                                  pb.ReadOperationLogResponse, self._api.timeout_s)
        return b"".join(part.data for part in parts).decode("utf-8", "replace")

    def __repr__(self) -> str:
        return f"<tactus.Job {self.name}, {self.kind}, {self.state}>"


def _given(message: Any, name: str) -> Optional[float]:
    return getattr(message, name) if message.HasField(name) else None


def _point_of(p: Any) -> LearningPoint:
    return LearningPoint(
        p.phase, p.part, p.iteration, p.max_iterations, _given(p, "log_likelihood"),
        _given(p, "loss"), _given(p, "accuracy"), _given(p, "validation_loss"),
        _given(p, "validation_accuracy"), p.elapsed_ms / 1000)


def _accuracy_of(a: Any) -> Accuracy:
    return Accuracy(a.correct, a.contacts, a.low, a.high)


def _anytime_of(seconds: Iterable[float], anytime: Iterable[Any]) -> Mapping[float, Accuracy]:
    return {second: _accuracy_of(a) for second, a in zip(seconds, anytime)}


def evaluation_of(e: Any) -> Evaluation:
    classes = tuple(e.class_names)
    counts = tuple(e.confusion)
    size = len(classes)
    trained = e.trained_on_data if e.HasField("trained_on_data") else None
    return Evaluation(
        _accuracy_of(e.accuracy), e.never_felt, e.log_loss, e.calibration_error, classes,
        tuple(counts[i * size:(i + 1) * size] for i in range(size)),
        _anytime_of(e.anytime_s, e.anytime), trained,
        tuple((wrong.name, wrong.label, wrong.answer) for wrong in e.wrong),
        {q.name: QuestionReport(_accuracy_of(q.accuracy), _anytime_of(e.anytime_s, q.anytime))
         for q in e.questions},
        tuple(ReliabilityBin(b.low, b.high, b.confidence, _accuracy_of(b.accuracy))
              for b in e.reliability))


def _result_of(r: Any) -> Result:
    evaluation = None
    if r.HasField("evaluation"):
        evaluation = evaluation_of(r.evaluation)
    elif r.HasField("comparison"):
        evaluation = evaluation_of(r.comparison.candidate)
    return Result(r.model_version, evaluation, r.comparison.failure, tuple(r.unusable_trials),
                  r.preset_choice.preset)
