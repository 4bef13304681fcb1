"""How far long work is, as a bar or as lines."""

from __future__ import annotations

import sys


class Bar:
    """A bar of tqdm if it is there, else a line on standard error for each
    phase of the work."""

    def __init__(self, work: str) -> None:
        self._work = work
        self._phase = ""
        try:
            from tqdm.auto import tqdm
        except ImportError:
            self._bar = None
        else:
            self._bar = tqdm(total=100, unit="%", leave=False)

    def show(self, phase: str, fraction: float) -> None:
        """``fraction``: 0 to 1 of the phase."""
        if self._bar is not None:
            self._bar.set_description(phase)
            self._bar.n = round(100 * fraction)
            self._bar.refresh()
        elif phase != self._phase:
            print(f"{self._work}: {phase}", file=sys.stderr)
        self._phase = phase

    def close(self) -> None:
        if self._bar is not None:
            self._bar.close()
