# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Tables for a terminal and for a Markdown page."""

from collections.abc import Sequence
from dataclasses import dataclass

from msss_graphslam.cli.console import Console, Row

__all__ = ["Table"]


@dataclass(frozen=True, slots=True)
class Table:
    """A ``title``, a ``header`` and ``rows`` of as many cells."""

    title: str
    header: Row
    rows: Sequence[Row]

    def show(self, console: Console) -> None:
        """Print the table."""
        console.table(self.header, self.rows, self.title)

    def markdown(self) -> str:
        """Return the table without its title; columns but the first are aligned to the right."""
        rule = ["---", *["---:"] * (len(self.header) - 1)]
        return "\n".join(f"| {' | '.join(row)} |" for row in (self.header, rule, *self.rows))
