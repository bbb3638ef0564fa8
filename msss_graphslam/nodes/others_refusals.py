# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What the other nodes of a namespace have refused and lost, as they say on /diagnostics."""

from collections import Counter
from contextlib import suppress
from typing import Any

__all__ = ["OthersRefusals"]

_REFUSED, _LOST = "refused/", "lost/"


class OthersRefusals:
    """The newest counts of every other node of the namespace.

    ``name`` is the own node's full name.
    """

    def __init__(self, name: str) -> None:
        self._own = name
        self._counts: dict[str, Counter[str]] = {}

    @property
    def total(self) -> Counter[str]:
        """All counts that are not 0, summed over the nodes."""
        return sum(self._counts.values(), Counter())

    def hear(self, message: Any) -> None:
        """Note the counts in a diagnostic_msgs/DiagnosticArray."""
        for status in message.status:
            if status.name != self._own and _namespace(status.name) == _namespace(self._own):
                self._counts[status.name] = _counts(status)

    def clear(self) -> None:
        """Forget all."""
        self._counts.clear()


def _namespace(name: str) -> str:
    return name.rpartition("/")[0]


def _counts(status: Any) -> Counter[str]:
    counts: Counter[str] = Counter()
    for entry in status.values:
        with suppress(ValueError):
            if entry.key.startswith(_REFUSED):
                counts[entry.key.removeprefix(_REFUSED)] += int(entry.value)
            elif entry.key.startswith(_LOST):
                counts[entry.key] += int(entry.value)
    return counts
