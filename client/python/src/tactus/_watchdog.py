"""Cancels calls whose server does not respond in time."""

from __future__ import annotations

import threading
import time
import weakref
from typing import Optional

from tactus._call import Call

# How often it looks. Timeouts are seconds, so this is soon enough.
_PERIOD_S = 0.1


class Watchdog:
    """One thread for all calls of a process; it ends when there are none."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._calls: "weakref.WeakSet[Call]" = weakref.WeakSet()
        self._thread: Optional[threading.Thread] = None

    def watch(self, call: Call) -> None:
        """Cancels ``call`` when it is past its ``due``, until it is gone."""
        with self._lock:
            self._calls.add(call)
            if self._thread is None:
                self._thread = threading.Thread(
                    target=self._run, name="tactus-watchdog", daemon=True)
                self._thread.start()

    def forget(self, call: Call) -> None:
        with self._lock:
            self._calls.discard(call)

    def _run(self) -> None:
        while True:
            time.sleep(_PERIOD_S)
            now = time.monotonic()
            with self._lock:
                if not self._calls:
                    self._thread = None
                    return
                late = [call for call in self._calls
                        if call.due is not None and call.due <= now and not call.expired]
            for call in late:
                call.expired = True
                call.cancel()


WATCHDOG = Watchdog()
