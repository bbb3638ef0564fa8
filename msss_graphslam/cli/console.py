# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What a command says: results on standard output, progress and remarks on standard error."""

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import rich.box
import rich.console
import rich.progress
import rich.table
from rich.console import JustifyMethod
from rich.markup import escape

from msss_graphslam.cli.exit_codes import ExitCode

if TYPE_CHECKING:
    from msss_graphslam.offline.estimation import Progress

__all__ = ["Console", "Row"]

Row = Sequence[str]

_PIPE_WIDTH = 200


class Console:
    """A terminal, or a pipe that gets the same as plain lines.

    Quiet, nothing but results asked for as JSON and errors are shown.
    """

    def __init__(self, *, quiet: bool = False, as_json: bool = False) -> None:
        self._quiet = quiet
        self._as_json = as_json
        self._out = _rich_console(stderr=False)
        self._err = _rich_console(stderr=True)

    @contextmanager
    def progress(self) -> Iterator["Progress"]:
        """Give a callable that shows how far the work is, until it is done."""
        if self._quiet:
            yield _say_nothing
        elif self._err.is_terminal:
            with _bar(self._err) as bar:
                task = bar.add_task("", total=1.0)
                yield lambda fraction, what: bar.update(task, completed=fraction, description=what)
        else:
            yield _PlainProgress(self.remark)

    def remark(self, text: str) -> None:
        """Say something that is not the result."""
        if not self._quiet:
            self._err.print(escape(text), soft_wrap=True)

    def error(self, text: str) -> None:
        """Say in one line what went wrong, also when quiet."""
        self._err.print(escape(" ".join(text.split())), soft_wrap=True)

    def result(self, data: Mapping[str, Any], show: Callable[[], None]) -> None:
        """Print a result: the data as JSON where that was asked for, else by calling show."""
        if self._as_json:
            self._out.file.write(json.dumps(data, indent=2, allow_nan=False) + "\n")
        elif not self._quiet:
            show()

    def lost(self, what: str) -> ExitCode:
        """Say what data were lost or refused, nothing if empty; return the code to end with."""
        if not what:
            return ExitCode.CLEAN
        self.remark(f"lost or refused: {what}")
        return ExitCode.DATA_LOST

    def line(self, text: str) -> None:
        """Print a line of the result."""
        self._out.print(escape(text), soft_wrap=True)

    def table(self, header: Row, rows: Sequence[Row], title: str = "") -> None:
        """Print a table, numbers to the right."""
        table = rich.table.Table(
            title=title or None, title_justify="left", box=rich.box.SIMPLE_HEAD, pad_edge=False
        )
        for number, (name, cells) in enumerate(zip(header, zip(*rows, strict=True), strict=True)):
            justify: JustifyMethod = "right" if all(map(_is_numeric, cells)) else "left"
            table.add_column(escape(name), justify=justify, no_wrap=number == 0, overflow="fold")
        for row in rows:
            table.add_row(*map(escape, row))
        self._out.print(table)


class _PlainProgress:
    """A line for each new stage and for each tenth of the whole."""

    def __init__(self, write: Callable[[str], None]) -> None:
        self._write = write
        self._last = ("", -1)

    def __call__(self, fraction: float, what: str) -> None:
        state = (what, int(10.0 * fraction))
        if state != self._last:
            self._last = state
            self._write(f"{100.0 * fraction:3.0f} % {what}")


def _is_numeric(cell: str) -> bool:
    return not cell or cell.lstrip("-")[:1].isdigit()


def _rich_console(*, stderr: bool) -> rich.console.Console:
    console = rich.console.Console(stderr=stderr, highlight=False)
    if not console.is_terminal:
        console.width = _PIPE_WIDTH
    return console


def _bar(console: rich.console.Console) -> rich.progress.Progress:
    return rich.progress.Progress(
        rich.progress.BarColumn(),
        rich.progress.TaskProgressColumn(),
        rich.progress.TimeRemainingColumn(),
        rich.progress.TextColumn("{task.description}"),
        console=console,
        transient=True,
    )


def _say_nothing(fraction: float, what: str) -> None:
    """Show no progress."""
    del fraction, what
