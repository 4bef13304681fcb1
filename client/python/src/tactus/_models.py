"""Model versions and the aliases under which they are served."""

from __future__ import annotations

import datetime
from dataclasses import dataclass
from typing import Any, Optional, Tuple

from tactus._names import time_of


@dataclass(frozen=True)
class ModelVersion:
    """One immutable version of a model, and its origin."""

    #: "models/M/versions/V".
    name: str
    #: SHA-256 of the bundle, hexadecimal.
    sha256: str
    bytes: int
    created: datetime.datetime
    classes: Tuple[str, ...]
    #: Layout class that it was trained on; empty accepts any.
    layout: str
    #: The server's program or command line provides it.
    built_in: bool
    #: The job that made it, and the dataset version; empty if it was imported.
    operation: str
    dataset_version: str
    trials: int
    #: Aliases that name it now.
    aliases: Tuple[str, ...]
    requester: str

    def __str__(self) -> str:
        return self.name


@dataclass(frozen=True)
class Gate:
    """What a new version of an alias must pass: it is at least as good as the
    present one on the contacts of a dataset version, within these margins."""

    #: "datasets/D/versions/V".
    dataset_version: str
    accuracy_margin: float = 0.0
    log_loss_margin: float = 0.0
    calibration_margin: float = 0.0


@dataclass(frozen=True)
class Alias:
    """A name for the version that is served."""

    #: "aliases/A".
    name: str
    model_version: str
    #: Changes with every change of the alias.
    etag: str
    #: The version before; empty if there was none.
    previous_version: str
    #: A second version, and how many robots of 1,000 get it.
    canary_version: str
    canary_per_mille: int
    gate: Optional[Gate]
    #: A version that answers logged contacts unseen; empty if there is none.
    shadow_version: str

    def __str__(self) -> str:
        return f"{self.name} -> {self.model_version}"


@dataclass(frozen=True)
class AliasChange:
    """One change of an alias."""

    model_version: str
    time: datetime.datetime
    requester: str
    forced: bool
    rollback: bool


def model_of(m: Any) -> ModelVersion:
    return ModelVersion(m.name, m.sha256, m.bytes, time_of(m.create_time_ms),
                        tuple(m.class_names), m.layout_class, m.built_in, m.operation,
                        m.train.dataset_version, m.trials, tuple(m.aliases), m.requester)


def alias_of(a: Any) -> Alias:
    gate = None
    if a.HasField("gate"):
        gate = Gate(a.gate.dataset_version, a.gate.accuracy_margin, a.gate.log_loss_margin,
                    a.gate.calibration_margin)
    return Alias(a.name, a.model_version, a.etag, a.previous_version, a.canary.model_version,
                 a.canary.per_mille, gate, a.shadow_version)


def change_of(c: Any) -> AliasChange:
    return AliasChange(c.model_version, time_of(c.time_ms), c.requester, c.forced, c.rollback)
