"""TouchClassifier: a scikit-learn estimator that a server trains."""

from __future__ import annotations

import uuid
from typing import Any, Dict, List, Optional, Sequence

import numpy
import numpy.typing

from tactus._client import Client
from tactus._errors import Error, invalid
from tactus._skin import Skin
from tactus._trials import Trial

Array = numpy.typing.NDArray[Any]


class TouchClassifier:
    """An estimator of scikit-learn: recordings in, classes out.

    ``X`` is a list of recordings, each [frames, rows, columns(, 3)] of the
    skin's dtype; they may have different lengths. ``y`` has their labels::

        model = tactus.TouchClassifier(skin=palm, preset="ridge")
        model.fit(X, y)
        model.predict_proba(X)  # [recordings, classes]
        sklearn.model_selection.cross_val_score(model, X, y, cv=5)

    ``fit`` uploads them to a dataset of the server ``address`` (TACTUS_SERVER),
    trains there, and keeps both until ``delete``. Predictions stream each
    recording, so they are what a robot's stream answers at its end. A recording
    that the skin never felt gets the shares of the classes in training.

    It follows the conventions (``get_params``, ``clone``, pickle), but not all of
    ``check_estimator``, which takes no lists of recordings.
    """

    # So that scikit-learn stratifies its folds.
    _estimator_type = "classifier"

    def __init__(self, skin: Optional[Skin] = None, address: Optional[str] = None,
                 preset: str = "", seed: int = 1, timeout_s: float = 3600.0) -> None:
        self.skin = skin
        self.address = address
        self.preset = preset
        self.seed = seed
        self.timeout_s = timeout_s

    def get_params(self, deep: bool = True) -> Dict[str, Any]:
        """The arguments of the constructor."""
        return {name: getattr(self, name)
                for name in ("skin", "address", "preset", "seed", "timeout_s")}

    def set_params(self, **params: Any) -> "TouchClassifier":
        """Changes arguments of the constructor."""
        known = self.get_params()
        for name, value in params.items():
            if name not in known:
                raise invalid("parameter", name, ", ".join(known))
            setattr(self, name, value)
        return self

    def fit(self, X: Sequence[Array], y: Sequence[Any]) -> "TouchClassifier":
        """Trains a model of these recordings. INVALID_TRAINING_DATA,
        INVALID_TRIAL, and the errors of Client.train."""
        if len(X) != len(y):
            raise invalid("number of labels", len(y), f"{len(X)}, one for each recording")
        labels = numpy.asarray(y)
        trials = [Trial(taxels=frames, label=str(label), skin=self._skin())
                  for frames, label in zip(X, labels)]
        name = f"sklearn-{uuid.uuid4().hex[:16]}"
        with self._client() as client:
            dataset = client.create_dataset(name)
            dataset.upload(trials)
            job = client.train(f"{name}@1", name, preset=self.preset, seed=self.seed)
            #: The version of the model on the server.
            self.model_version_ = job.wait(self.timeout_s).model_version
            version = client.model(self.model_version_)
        #: [classes] the labels, sorted as scikit-learn does.
        self.classes_ = numpy.unique(labels)
        order = {str(label): i for i, label in enumerate(self.classes_)}
        missing = set(order) - set(version.classes)
        if missing:
            raise Error(f"the model has no classes {sorted(missing)}", reason="INVALID_RESPONSE",
                        code="INTERNAL")
        self._order = order
        counts = numpy.array([(labels == label).sum() for label in self.classes_], float)
        self._shares = counts / counts.sum()
        return self

    def predict_proba(self, X: Sequence[Array]) -> Array:
        """[recordings, classes] the probabilities at the end of each recording,
        in the order of ``classes_``."""
        if not hasattr(self, "model_version_"):
            raise Error("this TouchClassifier is not fitted", reason="INVALID_MODEL",
                        code="FAILED_PRECONDITION", advice="call fit before")
        rows: List[Array] = []
        with self._client() as client, client.stream(
                self._skin(), model=self.model_version_.replace("models/", "").replace(
                    "/versions/", "@"), cadence="events", frames_per_message=64) as stream:
            for frames in X:
                stream.push_many(numpy.ascontiguousarray(frames))
                final = stream.end_trial()
                row = self._shares.copy()
                if final.main is not None:
                    for name, probability in final.main.classes.items():
                        row[self._order[name]] = probability
                rows.append(row)
        return numpy.stack(rows) if rows else numpy.zeros((0, len(self.classes_)))

    def predict(self, X: Sequence[Array]) -> Array:
        """[recordings] the most probable labels."""
        best = self.predict_proba(X).argmax(axis=1)
        labels: Array = self.classes_[best]
        return labels

    def score(self, X: Sequence[Array], y: Sequence[Any]) -> float:
        """The fraction of recordings that get their label."""
        return float((self.predict(X) == numpy.asarray(y)).mean())

    def delete(self) -> None:
        """Deletes model and dataset from the server; it predicts no more."""
        with self._client() as client:
            client.delete_model(self.model_version_)
            client.dataset(self.model_version_.split("/")[1]).delete()
        del self.model_version_

    def _skin(self) -> Skin:
        if self.skin is None:
            raise invalid("skin", "absent", "a tactus.Skin")
        return self.skin

    def _client(self) -> Client:
        return Client(self.address)

    def __repr__(self) -> str:
        fitted = getattr(self, "model_version_", "not fitted")
        return f"<tactus.TouchClassifier of {getattr(self.skin, 'name', None)}, {fitted}>"
