"""TouchClassifier: an estimator of scikit-learn for recordings of a skin."""

from __future__ import annotations

import contextlib
import json
import os
import uuid
from typing import Any, Dict, Iterator, List, Optional, Sequence, Union

import numpy
import numpy.typing

from tactus._answers import Answer
from tactus._client import Client
from tactus._errors import Error, invalid
from tactus._inferred import inferred_skin
from tactus._local import Classifier
from tactus._skin import TAXEL_TYPES, Skin
from tactus._stream import Stream
from tactus._training import train
from tactus._trials import Trial

Array = numpy.typing.NDArray[Any]

_PARAMETERS = ("skin", "preset", "seed", "threads", "address", "verbose", "timeout_s")
# Frames of a recording that are sent together.
_CHUNK = 64
# What a note has room for.
_MOST_NOTED_CLASSES = 64


class TouchClassifier:
    """An estimator of scikit-learn: recordings in, classes out.

    ``X`` is a list of recordings, each [frames, rows, columns] or [frames, rows,
    columns, 3], of uint16, int16 or float32; they may have different lengths.
    ``y`` has their labels::

        model = tactus.TouchClassifier()
        model.fit(X, y)
        model.predict_proba(X)         # [recordings, classes] at their ends
        model.predict_proba_so_far(X)  # a list of [frames, classes]
        sklearn.model_selection.cross_val_score(model, X, y, cv=5)

    ``fit`` trains in this process, for which the wheel must have the compiled
    module. Other threads run meanwhile, and KeyboardInterrupt ends it. With
    ``address`` it uploads the recordings to a dataset of that server, trains
    there, and keeps both until ``delete``.

    Predictions stream each recording as one contact and know nothing of the
    frames that follow. Before the skin is touched, and for a recording that
    never touches it, they are the shares of the classes in training.

    It follows the conventions (``get_params``, ``clone``, ``Pipeline``), but not
    all of ``check_estimator``, which takes no lists of recordings. A fitted one
    is not pickled: ``save`` and ``load`` write and read a bundle, which
    trainctl, servers and :class:`tactus.Classifier` read as well.
    """

    # So that scikit-learn stratifies its folds.
    _estimator_type = "classifier"

    #: [classes] the labels, sorted as scikit-learn does.
    classes_: Array
    #: The skin of the recordings.
    skin_: Skin
    #: The version of the model on the server, if ``address`` is given.
    model_version_: str

    def __init__(self, skin: Optional[Skin] = None, preset: str = "", seed: int = 1,
                 threads: Optional[int] = None, address: Optional[str] = None,
                 verbose: bool = False, timeout_s: float = 3600.0) -> None:
        """``skin``: what the recordings are of. None: a flat grid of their shape
        with 5 mm between taxels, 100 frames per second, and values as they are
        (``scale`` 1, "counts"), whose thresholds follow from what is read.

        ``preset``: as of ``trainctl fit``; empty: chosen by an inner
        cross-validation. ``threads``: those of a training in this process; None:
        one for each processor. ``verbose``: show progress, with tqdm if it is
        there. ``timeout_s``: how long a training on a server may take.
        """
        self.skin = skin
        self.preset = preset
        self.seed = seed
        self.threads = threads
        self.address = address
        self.verbose = verbose
        self.timeout_s = timeout_s

    def get_params(self, deep: bool = True) -> Dict[str, Any]:
        """The arguments of the constructor."""
        return {name: getattr(self, name) for name in _PARAMETERS}

    def set_params(self, **params: Any) -> "TouchClassifier":
        """Changes arguments of the constructor."""
        for name, value in params.items():
            if name not in _PARAMETERS:
                raise invalid("parameter", name, ", ".join(_PARAMETERS))
            setattr(self, name, value)
        return self

    def fit(self, X: Sequence[Array], y: Sequence[Any],
            groups: Optional[Sequence[Any]] = None) -> "TouchClassifier":
        """Trains a model of these recordings.

        ``groups``: for each recording the object, the person or the session that
        must not be on both sides of an inner test. ``cross_val_score`` passes them
        on only as ``fit_params={"groups": groups}``; its ``groups`` is for its own
        folds. INVALID_TRAINING_DATA, INVALID_TRIAL, INVALID_CONFIG; with
        ``address`` the errors of Client.train.
        """
        for name, values in (("labels", y), ("groups", groups)):
            if values is not None and len(values) != len(X):
                raise invalid(f"number of {name}", len(values),
                              f"{len(X)}, one for each recording")
        skin = inferred_skin(X) if self.skin is None else self.skin
        labels = numpy.asarray(y)
        classes, counts = numpy.unique(labels, return_counts=True)
        names = [str(label) for label in classes]
        kinds = [""] * len(X) if groups is None else [str(group) for group in groups]
        # Errors name a recording by its place.
        trials = [Trial(taxels=numpy.asarray(frames), label=str(label), skin=skin, material=group,
                        id=f"{i:06d}")
                  for i, (frames, label, group) in enumerate(zip(X, labels, kinds))]
        note = _note(skin, labels.dtype, counts)
        if self.address is None:
            bundle = train(trials, preset=self.preset, seed=self.seed, threads=self.threads,
                           command="tactus.TouchClassifier.fit", note=note, verbose=self.verbose)
            made = Classifier.decode(bundle, "TouchClassifier")
            self._check_classes(names, made.classes)
            self._forget()
            self._bundle, self._classifier = bundle, made
        else:
            version = self._train_there(trials, names, note)
            self._forget()
            self.model_version_ = version
        self.skin_ = skin
        self.classes_ = classes
        self._order = {name: i for i, name in enumerate(names)}
        self._shares = counts / counts.sum()
        return self

    def predict_proba(self, X: Sequence[Array]) -> Array:
        """[recordings, classes] the probabilities at the end of each recording,
        in the order of ``classes_``."""
        self._check_fitted()
        rows: List[Array] = []
        with self._stream("events") as stream:
            for frames in X:
                row = self._shares
                if len(frames):
                    stream.push_many(numpy.ascontiguousarray(frames))
                    row = self._row(stream.end_trial(), row)
                rows.append(row)
        return numpy.stack(rows) if rows else numpy.zeros((0, len(self.classes_)))

    def predict_proba_so_far(self, X: Sequence[Array]) -> List[Array]:
        """For each recording [frames, classes]: what is known after each frame,
        from that frame and those before it."""
        self._check_fitted()
        tables: List[Array] = []
        before = 0
        with self._stream("interval") as stream:
            for recording in X:
                frames = numpy.ascontiguousarray(recording)
                table = numpy.full((len(frames), len(self.classes_)), numpy.nan)
                for start in range(0, len(frames), _CHUNK):
                    for answer in stream.push_many(frames[start:start + _CHUNK]):
                        self._put(answer, before, table)
                if len(frames):
                    final = stream.end_trial()
                    for answer in stream.poll():
                        self._put(answer, before, table)
                    self._put(final, before, table)
                _fill_forward(table, self._shares)
                before += len(frames)
                tables.append(table)
        return tables

    def predict(self, X: Sequence[Array]) -> Array:
        """[recordings] the most probable labels."""
        best = self.predict_proba(X).argmax(axis=1)
        labels: Array = self.classes_[best]
        return labels

    def score(self, X: Sequence[Array], y: Sequence[Any]) -> float:
        """The fraction of recordings that get their label."""
        return float((self.predict(X) == numpy.asarray(y)).mean())

    def save(self, path: Union[str, "os.PathLike[str]"]) -> None:
        """Writes the model's bundle to a file."""
        self._check_fitted()
        if self._on_server():
            with self._client() as client:
                client.export_model(self.model_version_, path)
            return
        with open(path, "wb") as file:
            file.write(self._bundle)

    @classmethod
    def load(cls, path: Union[str, "os.PathLike[str]"],
             skin: Optional[Skin] = None) -> "TouchClassifier":
        """A fitted estimator, which predicts in this process.

        ``path``: a file of ``save``, or any other bundle. ``skin``: what the
        recordings are of. None: as in ``fit``; for another bundle, the skin of
        its training in its unit, as float32. IO, BUNDLE_CORRUPT,
        BUNDLE_VERSION, INVALID_MODEL.
        """
        try:
            with open(path, "rb") as file:
                bundle = file.read()
        except OSError as error:
            raise Error(f"{os.fspath(path)}: {error.strerror}", reason="IO",
                        code="FAILED_PRECONDITION") from error
        made = Classifier.decode(bundle, os.fspath(path))
        noted = _noted(made.note)
        given = skin or _skin_of(made, noted)
        model = cls(skin=skin)
        model._bundle, model._classifier = bundle, made
        model.skin_ = given
        classes = numpy.asarray(made.classes)
        dtype = str(noted.get("labels", "str"))
        if dtype == "bool":
            classes = classes == "True"
        elif dtype != "str":
            classes = classes.astype(dtype)
        order = numpy.argsort(classes, kind="stable")
        model.classes_ = classes[order]
        model._order = {made.classes[k]: i for i, k in enumerate(order)}
        counts = numpy.asarray(noted.get("counts", []), float)
        if len(counts) != len(classes):
            counts = numpy.ones(len(classes))
        model._shares = counts / counts.sum()
        return model

    def delete(self) -> None:
        """Deletes model and dataset from the server; it predicts no more."""
        self._check_fitted()
        if not self._on_server():
            raise Error("the model is in this process, not on a server",
                        code="FAILED_PRECONDITION")
        with self._client() as client:
            client.delete_model(self.model_version_)
            client.dataset(self.model_version_.split("/")[1]).delete()
        del self.model_version_

    def __getstate__(self) -> Dict[str, Any]:
        if "_bundle" in self.__dict__:
            raise Error("a fitted TouchClassifier is not pickled", code="UNIMPLEMENTED",
                        advice="write it with save(path), and read it with "
                               "TouchClassifier.load(path)")
        return dict(self.__dict__)

    def __sklearn_tags__(self) -> Any:
        # Releases from 1.6 on ask for it instead of _estimator_type.
        from sklearn.utils import ClassifierTags, Tags, TargetTags

        return Tags(estimator_type="classifier", target_tags=TargetTags(required=True),
                    classifier_tags=ClassifierTags())

    def __sklearn_is_fitted__(self) -> bool:
        return self._on_server() or "_bundle" in self.__dict__

    def _on_server(self) -> bool:
        return "model_version_" in self.__dict__

    def _check_fitted(self) -> None:
        if not self.__sklearn_is_fitted__():
            raise Error("this TouchClassifier is not fitted", reason="INVALID_MODEL",
                        code="FAILED_PRECONDITION", advice="call fit before")

    def _forget(self) -> None:
        """The model before."""
        for name in ("model_version_", "_bundle", "_classifier"):
            self.__dict__.pop(name, None)

    def _train_there(self, trials: List[Trial], names: List[str], note: str) -> str:
        name = f"sklearn-{uuid.uuid4().hex[:16]}"
        with self._client() as client:
            client.create_dataset(name).upload(trials)
            job = client.train(f"{name}@1", name, preset=self.preset, seed=self.seed, note=note)
            try:
                version = job.wait(self.timeout_s, progress=self.verbose).model_version
            except KeyboardInterrupt:
                job.cancel()
                raise
            self._check_classes(names, client.model(version).classes)
        return version

    @staticmethod
    def _check_classes(names: Sequence[str], classes: Sequence[str]) -> None:
        missing = set(names) - set(classes)
        if missing:
            raise Error(f"the model has no classes {sorted(missing)}", reason="INVALID_RESPONSE",
                        code="INTERNAL")

    @contextlib.contextmanager
    def _stream(self, cadence: str) -> Iterator[Stream]:
        # A model learns a recording as one contact, which its end ends.
        options: Dict[str, Any] = {"cadence": cadence, "never_release": True,
                                   "frames_per_message": _CHUNK}
        if not self._on_server():
            with self._classifier.stream(self.skin_, **options) as stream:
                yield stream
            return
        if cadence == "interval":
            # So that each push waits for its answer, and none is superseded.
            options["frames_per_message"] = 1
        version = self.model_version_.replace("models/", "").replace("/versions/", "@")
        with self._client() as client, client.stream(self.skin_, model=version,
                                                     **options) as stream:
            yield stream

    def _row(self, answer: Answer, before: Array) -> Array:
        """[classes] of an answer; ``before`` if it has no contact."""
        main = answer.main
        if main is None:
            return before
        row = numpy.zeros(len(self.classes_))
        for name, probability in main.classes.items():
            row[self._order[name]] = probability
        return row

    def _put(self, answer: Answer, before: int, table: Array) -> None:
        """``before``: frames of the recordings before."""
        frame = answer.sequence - 1 - before
        if answer.main is not None and 0 <= frame < len(table):
            table[frame] = self._row(answer, self._shares)

    def _client(self) -> Client:
        return Client(self.address)

    def __repr__(self) -> str:
        shown = [f"{name}={value!r}" for name, value in self.get_params().items()
                 if value not in (None, "", False) and name not in ("seed", "timeout_s")]
        return f"TouchClassifier({', '.join(shown)})"


def _fill_forward(table: Array, first: Array) -> None:
    """Rows without a number become as the row before."""
    for row in table:
        if numpy.isnan(row[0]):
            row[:] = first
        first = row


def _note(skin: Skin, labels: Any, counts: Array) -> str:
    """What a bundle does not say of an estimator's recordings."""
    noted: Dict[str, Any] = {"dtype": skin.dtype, "scale": skin.scale, "rate_hz": skin.rate_hz,
                             "labels": labels.name if labels.kind in "iufb" else "str"}
    if len(counts) <= _MOST_NOTED_CLASSES:
        noted["counts"] = counts.tolist()
    return json.dumps({"TouchClassifier": noted})


def _noted(note: str) -> Dict[str, Any]:
    """Nothing if an estimator did not note it."""
    try:
        noted = json.loads(note)["TouchClassifier"]
    except (ValueError, KeyError, TypeError):
        return {}
    return noted if isinstance(noted, dict) else {}


def _skin_of(made: Classifier, noted: Dict[str, Any]) -> Skin:
    skin = made.skin
    if skin is None:
        raise Error("the bundle is of no skin", code="FAILED_PRECONDITION",
                    advice="say with skin= what the recordings are of")
    if noted.get("dtype") not in TAXEL_TYPES:
        return skin
    return skin.replace(dtype=noted["dtype"], scale=float(noted["scale"]),
                        rate_hz=float(noted["rate_hz"]))
