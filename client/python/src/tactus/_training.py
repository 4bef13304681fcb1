"""Training in this process, by the code of trainctl fit and of a server's jobs."""

from __future__ import annotations

from typing import Any, List, Optional, Sequence, Tuple

import numpy

from tactus._errors import invalid
from tactus._local import made, native
from tactus._progress import Bar
from tactus._trials import Trial, borrowed_record
from tactus.v1 import operations_pb2

# No machine has more processors.
_MOST_THREADS = 1024


def train(trials: Sequence[Trial], *, preset: str = "", seed: int = 1,
          threads: Optional[int] = None, note: str = "", command: str = "", data: str = "",
          verbose: bool = False) -> bytes:
    """The bundle of a model of these trials, which have taxels.

    The same trials, ``preset`` and ``seed`` make the same model as ``trainctl
    fit`` does; ``note``, ``command`` and ``data`` are what its provenance says.
    ``threads``: None: one for each processor. Other threads of Python run
    meanwhile, and KeyboardInterrupt ends it.
    """
    module = native()
    if threads is not None and not 1 <= threads <= _MOST_THREADS:
        raise invalid("threads", threads, f"None, or 1 to {_MOST_THREADS}")
    if not 0 <= seed < 2**64:
        raise invalid("seed", seed, "0 to 2**64 - 1")
    spec = operations_pb2.TrainSpec(preset=preset, seed=seed, note=note)
    described: List[Tuple[bytes, Any]] = []
    for i, trial in enumerate(trials):
        taxels = numpy.ascontiguousarray(trial.taxels)
        little = taxels.dtype.newbyteorder("<")
        described.append((borrowed_record(trial, trial.id or f"{i:06d}"),
                          taxels.astype(little, copy=False)))
    bar = Bar("fit") if verbose else None
    try:
        bundle: bytes = made(module.fit(
            described, spec.SerializeToString(), threads or 0, command, data,
            bar.show if bar is not None else lambda phase, fraction: None))
    finally:
        if bar is not None:
            bar.close()
    return bundle
