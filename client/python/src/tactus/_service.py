"""What a client asks of the training service: datasets, jobs, models and
logged contacts."""

from __future__ import annotations

import os
from typing import Any, Iterator, List, Optional, Sequence, Tuple, Union

from tactus._connection import Api
from tactus._contacts import ContactLabel, Labels, LoggedContact, Replay, logged_of, replay_of
from tactus._datasets import Dataset, DatasetVersion, version_of
from tactus._errors import Error, invalid
from tactus._jobs import STATES, Job
from tactus._models import (Alias, AliasChange, Gate, ModelVersion, alias_of, change_of,
                            model_of)
from tactus._names import full_name, new_request_id, version_name
from tactus.v1 import contact_log_pb2, models_pb2, operations_pb2, training_pb2

_CHUNK_BYTES = 1024 * 1024
_SHARES = {"": 0, "recorded": 1, "even": 2}
_TRUTHS = {"": 0, "final": 1, "so_far": 2}

DatasetName = Union[str, Dataset, DatasetVersion]
ModelName = Union[str, ModelVersion]


class Service:
    """Base of Client. Names may be short: "arm" or "arm@3"."""

    def __init__(self, api: Api) -> None:
        self._api = api

    # Datasets.

    def create_dataset(self, name: str, description: str = "") -> Dataset:
        """Makes an empty dataset. DATASET_EXISTS, QUOTA_EXCEEDED."""
        dataset = Dataset(self._api, name)
        self._api.call("TrainingService/CreateDataset", training_pb2.CreateDatasetRequest(
            name=dataset.name, description=description), training_pb2.CreateDatasetResponse)
        return dataset

    def dataset(self, name: str) -> Dataset:
        """A dataset by its name. DATASET_NOT_FOUND."""
        dataset = Dataset(self._api, name)
        self._api.call("TrainingService/GetDataset",
                       training_pb2.GetDatasetRequest(name=dataset.name),
                       training_pb2.GetDatasetResponse, again=True)
        return dataset

    def datasets(self) -> List[Dataset]:
        """All datasets, by name."""
        return [Dataset(self._api, d.name) for d in self._api.pages(
            "TrainingService/ListDatasets", training_pb2.ListDatasetsRequest(page_size=1000),
            training_pb2.ListDatasetsResponse, "datasets")]

    # Jobs.

    def train(self, dataset: DatasetName, model: str, *, preset: str = "", seed: int = 1,
              features: Sequence[str] = (), networks: Optional[int] = None,
              epochs: Optional[int] = None, hmms_per_class: Optional[int] = None,
              skip_unusable: bool = False, note: str = "", truth: str = "", shares: str = "",
              with_cues: Sequence[str] = (), without_cues: Sequence[str] = (),
              questions: str = "", request_id: Optional[str] = None) -> Job:
        """Requests a training, which makes a new version of a model.

        ``preset``: "paper", "tuned", "world", "ridge", "trees", "nearest",
        "pattern", "whole-skin", "profile" or "auto". ``shares``: "recorded" or
        "even". ``truth``: "final" or "so_far". The others are those of
        ``trainctl train`` (docs/trainctl.md). INVALID_CONFIG,
        DATASET_NOT_FOUND, JOB_LIMIT, QUOTA_EXCEEDED.
        """
        spec = self._spec(dataset, full_name("models", model), preset, seed, features, networks,
                          epochs, hmms_per_class, skip_unusable, note, truth, shares, with_cues,
                          without_cues, questions)
        made = self._api.call(
            "TrainingService/TrainModel",
            training_pb2.TrainModelRequest(spec=spec, request_id=request_id or new_request_id()),
            training_pb2.TrainModelResponse, again=True)
        return Job(self._api, made.operation)

    def evaluate(self, dataset: DatasetName, model: Optional[ModelName] = None, *,
                 protocol: str = "", preset: str = "", seed: int = 1,
                 request_id: Optional[str] = None, **train: Any) -> Job:
        """Requests an evaluation: of a model's version or an alias, or of models
        that are fitted under a ``protocol``: "loco", "leave-one-material-out",
        "leave-one-out" or "k-fold"; ``preset`` and ``train`` as in ``train``."""
        spec = operations_pb2.EvaluateSpec(dataset_version=self._version_of(dataset))
        if model is not None:
            spec.model_version = self._model_version(model)
        else:
            if not protocol:
                raise invalid("protocol", "absent",
                              "loco, leave-one-material-out, leave-one-out or k-fold; or give "
                              "a model")
            spec.protocol = protocol
            spec.train.CopyFrom(self._spec(dataset, "", preset, seed, **train))
            spec.train.dataset_version = ""
        made = self._api.call(
            "TrainingService/EvaluateModel",
            training_pb2.EvaluateModelRequest(spec=spec,
                                              request_id=request_id or new_request_id()),
            training_pb2.EvaluateModelResponse, again=True)
        return Job(self._api, made.operation)

    def job(self, name: Union[str, int]) -> Job:
        """A job by its name or number. OPERATION_NOT_FOUND."""
        got = self._api.call(
            "OperationService/GetOperation",
            operations_pb2.GetOperationRequest(name=full_name("operations", str(name))),
            operations_pb2.GetOperationResponse, again=True)
        return Job(self._api, got.operation)

    def jobs(self, state: str = "") -> Iterator[Job]:
        """Jobs, the newest first; ``state`` as Job.state."""
        numbers = {name: number for number, name in STATES.items()}
        if state and state not in numbers:
            raise invalid("state", state, ", ".join(numbers))
        request: Any = operations_pb2.ListOperationsRequest(page_size=100)
        request.state = numbers.get(state, 0)
        for operation in self._api.pages("OperationService/ListOperations", request,
                                         operations_pb2.ListOperationsResponse, "operations"):
            yield Job(self._api, operation)

    # Models and aliases.

    def models(self, model: str = "") -> List[ModelVersion]:
        """Model versions, the newest of each model first."""
        request = models_pb2.ListModelVersionsRequest(
            model=full_name("models", model) if model else "", page_size=1000)
        return [model_of(m) for m in self._api.pages(
            "ModelService/ListModelVersions", request, models_pb2.ListModelVersionsResponse,
            "versions")]

    def model(self, name: str) -> ModelVersion:
        """"M@V", "M" for the newest version, or "aliases/A". MODEL_NOT_FOUND."""
        return model_of(self._api.call(
            "ModelService/GetModelVersion",
            models_pb2.GetModelVersionRequest(name=version_name(name)),
            models_pb2.GetModelVersionResponse, again=True).version)

    def export_model(self, model: ModelName, path: Union[str, "os.PathLike[str]"]) -> None:
        """Writes the bundle of a version to a file."""
        name = self._model_version(model)
        with open(path, "wb") as file:
            for part in self._api.receive(
                    "ModelService/ExportModel", models_pb2.ExportModelRequest(name=name),
                    models_pb2.ExportModelResponse, self._api.long_timeout_s):
                file.write(part.data)

    def import_model(self, model: str, path: Union[str, "os.PathLike[str]"]) -> ModelVersion:
        """Makes the bundle in a file a new version of a model."""

        def requests() -> Iterator[Any]:
            name = full_name("models", model)
            with open(path, "rb") as file:
                while True:
                    data = file.read(_CHUNK_BYTES)
                    if not data:
                        return
                    yield models_pb2.ImportModelRequest(model=name, data=data)
                    name = ""

        return model_of(self._api.send("ModelService/ImportModel", requests(),
                                       models_pb2.ImportModelResponse).version)

    def delete_model(self, model: ModelName) -> None:
        """Deletes a version. MODEL_IN_USE while an alias names it."""
        self._api.call("ModelService/DeleteModelVersion", models_pb2.DeleteModelVersionRequest(
            name=self._model_version(model)), models_pb2.DeleteModelVersionResponse)

    def aliases(self) -> List[Alias]:
        """Aliases by name."""
        return [alias_of(a) for a in self._api.call(
            "ModelService/ListAliases", models_pb2.ListAliasesRequest(),
            models_pb2.ListAliasesResponse, again=True).aliases]

    def alias(self, name: str = "default") -> Alias:
        """An alias by its name. ALIAS_NOT_FOUND."""
        wanted = full_name("aliases", name)
        aliases = self.aliases()
        for alias in aliases:
            if alias.name == wanted:
                return alias
        there = ", ".join(alias.name for alias in aliases) or "none"
        raise Error(f"{wanted} does not exist; there is {there}", reason="ALIAS_NOT_FOUND",
                    code="NOT_FOUND", advice="client.promote(version, alias) makes it")

    def update_alias(self, name: str = "default", *, canary: Optional[Tuple[ModelName, int]] = None,
                     gate: Optional[Gate] = None, shadow: Optional[ModelName] = None,
                     etag: str = "") -> Alias:
        """Sets the canary (a version, and robots of 1,000 that get it), the gate
        and the shadow of an alias; None removes what was there."""
        request = models_pb2.UpdateAliasRequest(name=full_name("aliases", name), etag=etag)
        if canary is not None:
            request.canary.model_version = self._model_version(canary[0])
            request.canary.per_mille = canary[1]
        if gate is not None:
            request.gate.dataset_version = full_name("datasets", gate.dataset_version)
            request.gate.accuracy_margin = gate.accuracy_margin
            request.gate.log_loss_margin = gate.log_loss_margin
            request.gate.calibration_margin = gate.calibration_margin
        if shadow is not None:
            request.shadow_version = self._model_version(shadow)
        return alias_of(self._api.call("ModelService/UpdateAlias", request,
                                       models_pb2.UpdateAliasResponse).alias)

    def promote(self, model: ModelName, alias: str = "default", *, force: bool = False,
                etag: str = "", request_id: Optional[str] = None) -> Job:
        """Requests that an alias names this version. Without a gate the job has
        ended when this returns. New streams get the version; open ones keep
        theirs."""
        spec = operations_pb2.PromoteSpec(
            alias=full_name("aliases", alias), model_version=self._model_version(model),
            etag=etag, force=force)
        made = self._api.call(
            "ModelService/PromoteModel",
            models_pb2.PromoteModelRequest(spec=spec, request_id=request_id or new_request_id()),
            models_pb2.PromoteModelResponse, long=True, again=True)
        return Job(self._api, made.operation)

    def rollback(self, alias: str = "default", *, etag: str = "") -> Alias:
        """Lets an alias name the version that it named before.
        NOTHING_TO_ROLL_BACK."""
        return alias_of(self._api.call(
            "ModelService/RollbackAlias",
            models_pb2.RollbackAliasRequest(name=full_name("aliases", alias), etag=etag),
            models_pb2.RollbackAliasResponse).alias)

    def alias_history(self, alias: str = "default") -> List[AliasChange]:
        """Which version an alias named, when and by whom; the newest first."""
        return [change_of(c) for c in self._api.call(
            "ModelService/ListAliasHistory",
            models_pb2.ListAliasHistoryRequest(name=full_name("aliases", alias)),
            models_pb2.ListAliasHistoryResponse, again=True).changes]

    # Logged contacts.

    def contacts(self, *, uncertain_first: bool = False, robot: str = "", model: str = "",
                 answer: str = "", only_unknown: bool = False, only_undecided: bool = False,
                 only_revised: bool = False, only_disagreeing: bool = False,
                 confidence_below: float = 0.0, labelled: Optional[bool] = None,
                 with_pictures: bool = False) -> Iterator[LoggedContact]:
        """The contacts that the server keeps, the newest or the least certain
        first. ``answer`` is a class or "QUESTION=VALUE". NO_CONTACT_LOG."""
        request = contact_log_pb2.ListContactsRequest(
            page_size=200, robot=robot, model=full_name("models", model) if model else "",
            answer=answer, only_unknown=only_unknown, only_undecided=only_undecided,
            only_revised=only_revised, only_disagreeing=only_disagreeing,
            confidence_below=confidence_below, with_pictures=with_pictures)
        if uncertain_first:
            request.order = contact_log_pb2.ListContactsRequest.ORDER_UNCERTAIN
        if labelled is not None:
            request.labelled = labelled
        for contact in self._api.pages("ContactLogService/ListContacts", request,
                                       contact_log_pb2.ListContactsResponse, "contacts"):
            yield logged_of(contact)

    def replay_contact(self, contact: Union[str, LoggedContact], *, model: str = "",
                       max_frames: int = 0, with_loads: bool = True) -> Replay:
        """Answers the frames of a contact once more; ``model`` as for a stream,
        empty for the version that answered."""
        request = contact_log_pb2.ReplayContactRequest(
            name=full_name("contacts", str(contact)), model=model, max_frames=max_frames,
            without_taxels=not with_loads)
        return replay_of(self._api.call(
            "ContactLogService/ReplayContact", request, contact_log_pb2.ReplayContactResponse,
            long=True, again=True))

    def label_contacts(self, dataset: Union[str, Dataset], labels: Labels, *, reason: str = "",
                       request_id: Optional[str] = None) -> DatasetVersion:
        """Makes contacts trials of a new version of a dataset::

            client.label_contacts("arm", {contact: "HU"}, reason="I saw it")
        """
        request = contact_log_pb2.LabelContactsRequest(
            dataset=full_name("datasets", str(dataset)), reason=reason,
            request_id=request_id or new_request_id())
        for contact, given in labels.items():
            label = given if isinstance(given, ContactLabel) else ContactLabel(given)
            request.labels.add(
                contact=full_name("contacts", str(contact)), label=label.label,
                object=label.object, condition=label.condition, material=label.material,
                prefilled=label.prefilled)
        return version_of(self._api.call(
            "ContactLogService/LabelContacts", request, contact_log_pb2.LabelContactsResponse,
            long=True, again=True).version)

    def _version_of(self, dataset: DatasetName) -> str:
        """A dataset's version in full; the newest if none is named."""
        name = full_name("datasets", str(dataset))
        return name if "/versions/" in name else Dataset(self._api, name).latest.name

    def _model_version(self, model: ModelName) -> str:
        name = version_name(str(model))
        if "/versions/" in name or name.startswith("aliases/"):
            return name
        return self.model(name).name

    def _spec(self, dataset: DatasetName, model: str, preset: str, seed: int,
              features: Sequence[str] = (), networks: Optional[int] = None,
              epochs: Optional[int] = None, hmms_per_class: Optional[int] = None,
              skip_unusable: bool = False, note: str = "", truth: str = "", shares: str = "",
              with_cues: Sequence[str] = (), without_cues: Sequence[str] = (),
              questions: str = "") -> Any:
        for name, value, known in (("shares", shares, _SHARES), ("truth", truth, _TRUTHS)):
            if value not in known:
                raise invalid(name, value, " or ".join(filter(None, known)))
        made: Any = operations_pb2.TrainSpec(
            dataset_version=self._version_of(dataset), model=model, preset=preset, seed=seed,
            features=features, networks=networks, epochs=epochs, hmms_per_class=hmms_per_class,
            skip_unusable=skip_unusable, note=note, with_cues=with_cues,
            without_cues=without_cues, questions=questions)
        made.truth = _TRUTHS[truth]
        made.shares = _SHARES[shares]
        return made
