# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Unexpected exceptions: told once, counted, and the node goes on."""

from collections import Counter
from collections.abc import Callable
from traceback import format_exc
from typing import Any

__all__ = ["Faults"]


class Faults:
    """Counts exceptions as "internal_error" and tells each type's first with its traceback."""

    def __init__(self, refused: Counter[str], log: Callable[[str], Any]) -> None:
        self._refused = refused
        self._log = log
        self._told: set[type[BaseException]] = set()

    def note(self, error: Exception, where: str) -> None:
        """Count the exception that is being handled."""
        self._refused["internal_error"] += 1
        if type(error) not in self._told:
            self._told.add(type(error))
            self._log(f"{where}: {error!r}; goes on without it\n{format_exc()}")

    def guarded(self, work: Callable[..., object], where: str) -> Callable[..., None]:
        """Return the callback as one that never raises."""

        def safely(*arguments: Any) -> None:
            try:
                work(*arguments)
            except Exception as error:
                self.note(error, where)

        return safely
