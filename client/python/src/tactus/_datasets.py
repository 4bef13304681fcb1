"""Datasets of the training service: labelled trials, in versions that never
change."""

from __future__ import annotations

import datetime
import hashlib
import time
from dataclasses import dataclass
from typing import Any, Callable, Iterator, List, Mapping, Optional, Sequence, Tuple

from tactus._connection import Api
from tactus._crc32c import crc32c
from tactus._errors import Error, may_retry
from tactus._names import full_name, new_request_id, time_of
from tactus._trials import Trial, from_record, to_record
from tactus.v1 import training_pb2 as pb
from tactus.v1 import trial_pb2

_CHUNK_BYTES = 1024 * 1024
# One call of WriteUpload; the server confirms at its end.
_CALL_BYTES = 32 * 1024 * 1024
_RETRIES = 10
_NOTES = {1: "duplicate", 2: "renamed", 3: "replaced"}


@dataclass(frozen=True)
class DatasetVersion:
    """One immutable set of trials."""

    #: "datasets/D/versions/V".
    name: str
    sha256: str
    created: datetime.datetime
    trials: int
    bytes: int
    #: Trials per label.
    labels: Mapping[str, int]
    added: int
    removed: int
    relabelled: int
    #: Uploaded trials that were left out because their frames are there already,
    #: and those that got another id.
    duplicates: int
    renamed: int
    requester: str
    reason: str

    @property
    def number(self) -> int:
        return int(self.name.rpartition("/")[2])

    def __str__(self) -> str:
        return self.name


@dataclass(frozen=True)
class TrialInfo:
    """What is known of a trial without reading it."""

    id: str
    label: str
    condition: str
    object: str
    material: str
    layout: str
    frames: int
    source: str
    bytes: int
    sha256: str


@dataclass(frozen=True)
class TrialNote:
    """What became of an uploaded trial: "duplicate", "renamed" or "replaced"."""

    kind: str
    id: str
    other_id: str
    new_id: str


@dataclass(frozen=True)
class Upload:
    """What an upload made."""

    version: DatasetVersion
    #: The first 100 trials that are not in the version as they were uploaded.
    notes: Tuple[TrialNote, ...]


class Dataset:
    """A named collection of trials; from ``client.dataset(name)``."""

    def __init__(self, api: Api, name: str) -> None:
        self._api = api
        #: "datasets/D".
        self.name = full_name("datasets", name)

    def __repr__(self) -> str:
        return f"<tactus.Dataset {self.name}>"

    def __str__(self) -> str:
        return self.name

    @property
    def versions(self) -> Tuple[DatasetVersion, ...]:
        """All versions, the oldest first."""
        got = self._api.call("TrainingService/GetDataset", pb.GetDatasetRequest(name=self.name),
                             pb.GetDatasetResponse, again=True)
        return tuple(version_of(version) for version in got.versions)

    @property
    def latest(self) -> DatasetVersion:
        """The newest version."""
        return self.version()

    def version(self, number: Optional[int] = None) -> DatasetVersion:
        """A version; without a number the newest."""
        got = self._api.call("TrainingService/GetDatasetVersion",
                             pb.GetDatasetVersionRequest(name=self._at(number)),
                             pb.GetDatasetVersionResponse, again=True)
        return version_of(got.version)

    def trials(self, version: Optional[int] = None, *, label: str = "", condition: str = "",
               material: str = "") -> List[TrialInfo]:
        """The trials of a version by id."""
        request = pb.ListTrialsRequest(
            dataset_version=self._at(version), page_size=1000, label=label, condition=condition,
            material=material)
        return [TrialInfo(t.id, t.label, t.condition, t.object, t.material, t.layout, t.frames,
                          t.source, t.bytes, t.sha256)
                for t in self._api.pages("TrainingService/ListTrials", request,
                                         pb.ListTrialsResponse, "trials")]

    def upload(self, trials: Sequence[Trial], *, replace: bool = False,
               replace_labels: bool = False, request_id: Optional[str] = None,
               progress: Optional[Callable[[int], None]] = None) -> Upload:
        """Makes a new version with these trials and those of the newest one.

        It survives a broken connection and a restart of the server. The same
        trials with the same ``request_id`` continue an upload that an earlier
        program began; without one, the id follows from the trials.

        ``replace``: the version has these trials only. ``replace_labels``: a
        trial with the same frames gets the label of the uploaded one; else that
        is refused. ``progress`` is called with the bytes that are confirmed.
        """
        return _Uploader(self._api, self.name, trials, progress).run(
            replace, replace_labels, request_id)

    def download(self, version: Optional[int] = None) -> List[Trial]:
        """All trials of a version, with their frames."""
        return list(self.iter_trials(version))

    def iter_trials(self, version: Optional[int] = None) -> Iterator[Trial]:
        """The same, one at a time."""
        pending = bytearray()
        for part in self._api.receive(
                "TrainingService/DownloadTrials",
                pb.DownloadTrialsRequest(dataset_version=self._at(version)),
                pb.DownloadTrialsResponse, self._api.long_timeout_s):
            pending += part.data
            while len(pending) >= 4:
                size = int.from_bytes(pending[:4], "little")
                if len(pending) < 4 + size:
                    break
                record = trial_pb2.TrialRecord.FromString(bytes(pending[4:4 + size]))
                del pending[:4 + size]
                yield from_record(record)
        if pending:
            raise Error("the trial pack ends within a record", reason="INVALID_RESPONSE",
                        code="INTERNAL")

    def relabel(self, trials: Sequence[str] = (), *, label: str, reason: str,
                from_label: str = "", request_id: Optional[str] = None) -> DatasetVersion:
        """Makes a new version in which trials, by id or source, have another
        label; without names all those with ``from_label``."""
        request = pb.RelabelTrialsRequest(
            dataset=self.name, trials=list(trials), from_label=from_label, label=label,
            reason=reason, request_id=request_id or new_request_id())
        got = self._api.call("TrainingService/RelabelTrials", request, pb.RelabelTrialsResponse,
                             long=True, again=True)
        return version_of(got.version)

    def remove(self, trials: Sequence[str], *, reason: str,
               request_id: Optional[str] = None) -> DatasetVersion:
        """Makes a new version without some trials of the newest one."""
        request = pb.RemoveTrialsRequest(
            dataset=self.name, trials=list(trials), reason=reason,
            request_id=request_id or new_request_id())
        got = self._api.call("TrainingService/RemoveTrials", request, pb.RemoveTrialsResponse,
                             long=True, again=True)
        return version_of(got.version)

    def delete(self) -> int:
        """Deletes the dataset; returns how many trials were removed from disk."""
        got = self._api.call("TrainingService/DeleteDataset",
                             pb.DeleteDatasetRequest(name=self.name), pb.DeleteDatasetResponse,
                             long=True)
        return int(got.removed_trials)

    def _at(self, version: Optional[int]) -> str:
        return self.name if version is None else f"{self.name}/versions/{version}"


def version_of(v: Any) -> DatasetVersion:
    return DatasetVersion(v.name, v.sha256, time_of(v.create_time_ms), v.trials, v.bytes,
                          dict(sorted(v.labels.items())), v.added, v.removed, v.relabelled, v.duplicates,
                          v.renamed, v.requester, v.reason)


class _Uploader:
    """Sends the pack of some trials: for each its length and its record. Records
    are made again after a break, so that none has to be kept."""

    def __init__(self, api: Api, dataset: str, trials: Sequence[Trial],
                 progress: Optional[Callable[[int], None]]) -> None:
        self._api = api
        self._dataset = dataset
        self._trials = trials
        self._progress = progress
        self._upload = ""

    def run(self, replace: bool, replace_labels: bool, request_id: Optional[str]) -> Upload:
        size, crc, digest = 0, 0, hashlib.sha256()
        for data in self._chunks():
            size += len(data)
            crc = crc32c(data, crc)
            digest.update(data)
        if request_id is None:
            # Of the dataset's version, too: the same trials may come again.
            newest = self._api.call("TrainingService/GetDataset",
                                    pb.GetDatasetRequest(name=self._dataset),
                                    pb.GetDatasetResponse, again=True).dataset.latest_version
            digest.update(f"{self._dataset} {newest} {replace} {replace_labels}".encode())
            request_id = f"python-{digest.hexdigest()}"
        created = self._api.call(
            "TrainingService/CreateUpload",
            pb.CreateUploadRequest(dataset=self._dataset, request_id=request_id, replace=replace,
                                   replace_labels=replace_labels),
            pb.CreateUploadResponse, again=True)
        self._upload = created.upload
        self._write(created.committed_size, size)
        request = pb.FinishUploadRequest(upload=self._upload, size=size, crc32c=crc)
        made = self._api.call("TrainingService/FinishUpload", request, pb.FinishUploadResponse,
                              long=True, again=True)
        return Upload(version_of(made.version), tuple(
            TrialNote(_NOTES.get(note.kind, ""), note.id, note.other_id, note.new_id)
            for note in made.notes))

    def _write(self, committed: int, size: int) -> None:
        failures, wait = 0, 0.025
        while committed < size:
            before = committed
            try:
                committed = self._api.send(
                    "TrainingService/WriteUpload", self._requests(committed),
                    pb.WriteUploadResponse).committed_size
            except Error as error:
                if failures == _RETRIES or not (
                        may_retry(error) or error.reason in ("OFFSET_MISMATCH",
                                                             "CHECKSUM_MISMATCH")):
                    raise
                failures += 1
                time.sleep(wait)
                wait = min(2 * wait, 5.0)
                committed = self._api.call(
                    "TrainingService/QueryWriteStatus",
                    pb.QueryWriteStatusRequest(upload=self._upload),
                    pb.QueryWriteStatusResponse, again=True).committed_size
            if committed > before:
                failures, wait = 0, 0.025
                if self._progress is not None:
                    self._progress(committed)

    def _requests(self, committed: int) -> Iterator[Any]:
        """The chunks of one call, from what the server has."""
        at = 0
        upload = self._upload
        for data in self._chunks():
            begin, at = at, at + len(data)
            if at <= committed:
                continue
            if begin < committed:
                data = data[committed - begin:]
                begin = committed
            yield pb.WriteUploadRequest(upload=upload, write_offset=begin, data=data,
                                        crc32c=crc32c(data))
            upload = ""
            if at - committed >= _CALL_BYTES:
                return

    def _chunks(self) -> Iterator[bytes]:
        """The pack in parts of 1 MiB."""
        pending = bytearray()
        for i, trial in enumerate(self._trials):
            record = to_record(trial, trial.id or f"{i:06}")
            pending += len(record).to_bytes(4, "little") + record
            while len(pending) >= _CHUNK_BYTES:
                yield bytes(pending[:_CHUNK_BYTES])
                del pending[:_CHUNK_BYTES]
        if pending:
            yield bytes(pending)
