# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Loop closures in figures, for the diagnostics."""

from collections import Counter
from collections.abc import Callable, Sequence

from msss_graphslam.core.types import Constraint, ConstraintKind

__all__ = ["ClosureCount"]


class ClosureCount:
    """How many loop closures were tried and accepted, and why the others were not."""

    def __init__(self, rows: dict[str, Callable[[], str | int | float]]) -> None:
        self._rows = rows
        self.tried = self.accepted = 0
        self.refusals: Counter[str] = Counter()
        rows["loop_closures/tried"] = lambda: self.tried
        rows["loop_closures/accepted"] = lambda: self.accepted

    def add(self, constraints: Sequence[Constraint]) -> None:
        """Count the loop closures among the constraints of a keyframe."""
        for constraint in constraints:
            if constraint.kind is not ConstraintKind.LOOP:
                continue
            self.tried += 1
            self.accepted += constraint.accepted
            if not constraint.accepted:
                self.refusals[constraint.refusal] += 1
                self._show(constraint.refusal)

    def clear(self) -> None:
        """Start anew."""
        self.tried = self.accepted = 0
        self.refusals.clear()

    def _show(self, reason: str) -> None:
        self._rows[f"loop_closures/{reason}"] = lambda: self.refusals[reason]
