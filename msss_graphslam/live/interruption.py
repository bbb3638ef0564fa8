# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Ctrl-C and SIGTERM as a wish to end, not as an exception in the middle of something."""

import signal
import time
from types import FrameType, TracebackType
from typing import Any

__all__ = ["Interruption"]

_SIGNALS = (signal.SIGINT, signal.SIGTERM)

_ECHO = 1.0
"""A signal this soon after the first is the same wish: launchers send it twice [s]."""


class Interruption:
    """While entered, the first signal is noted; a later one raises KeyboardInterrupt.

    Attributes
    ----------
    wished
        Whether a signal has come.
    deaf
        Set where not even a second signal may break off what is being done.
    """

    def __init__(self) -> None:
        self.wished = False
        self.deaf = False
        self._first = 0.0
        self._before: dict[signal.Signals, Any] = {}

    def __enter__(self) -> "Interruption":
        self._before = {number: signal.signal(number, self._note) for number in _SIGNALS}
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        for number, handler in self._before.items():
            signal.signal(number, handler)

    def _note(self, number: int, frame: FrameType | None) -> None:
        del number, frame
        now = time.monotonic()
        if not self.wished:
            self.wished, self._first = True, now
        elif not self.deaf and now - self._first > _ECHO:
            raise KeyboardInterrupt
