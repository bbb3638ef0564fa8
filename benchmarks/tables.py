# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Tables for a terminal and for a Markdown page."""

from argparse import ArgumentParser
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from msss_graphslam.cli.console import Console, Row

__all__ = ["Table", "add_folder", "publish"]


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


def add_folder(parser: ArgumentParser) -> None:
    """Add the option that says where bags and tables are kept."""
    parser.add_argument(
        "--out", type=Path, default=Path("bench"), help="folder of bags and tables"
    )


def publish(title: str, about: str, tables: Iterable[Table], console: Console, path: Path) -> None:
    """Print the tables as they come, and write them to a Markdown page."""
    console.line(about)
    page = [f"# {title}", about]
    for table in tables:
        table.show(console)
        page += [f"## {table.title}", table.markdown()]
    path.write_text("\n\n".join(page) + "\n", encoding="utf-8")
