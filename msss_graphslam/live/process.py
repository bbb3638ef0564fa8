# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""One child process that never outlives its parent and never gets the terminal's Ctrl-C."""

import ctypes
import os
import signal
import subprocess
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

__all__ = ["Command", "Process"]

_SET_PARENT_DEATH_SIGNAL = 1
"""``PR_SET_PDEATHSIG`` of ``linux/prctl.h``."""

# Looked up here: between fork and exec nothing may be imported or loaded.
_prctl = ctypes.CDLL(None).prctl


@dataclass(frozen=True, slots=True)
class Command:
    """What to start under which name.

    A process that ``returns`` is started again when it dies; the others run once. What it gets
    when its parent has died is ``orphaned``: nothing may go on publishing, but a recorder may
    have a file to close.
    """

    name: str
    arguments: tuple[str, ...]
    returns: bool = True
    orphaned: signal.Signals = signal.SIGKILL


class Process:
    """A command as a process in a session of its own; what it says is appended to a file."""

    def __init__(self, command: Command, log: Path, environment: Mapping[str, str]) -> None:
        self.command = command
        self.log = log
        self._environment = dict(environment)
        self._popen: subprocess.Popen[bytes] | None = None

    @property
    def exit_code(self) -> int | None:
        """The exit code, the negative signal that ended it, or None while it runs."""
        return None if self._popen is None else self._popen.poll()

    @property
    def is_running(self) -> bool:
        """Whether it has been started and has not ended."""
        return self._popen is not None and self._popen.poll() is None

    def start(self) -> None:
        """Start it, for the first time or again."""
        parent, orphaned = os.getpid(), self.command.orphaned

        def die_with_parent() -> None:
            _prctl(_SET_PARENT_DEATH_SIGNAL, int(orphaned), 0, 0, 0)
            if os.getppid() != parent:
                os._exit(1)

        with self.log.open("ab") as log:
            self._popen = subprocess.Popen(  # noqa: S603 - the table's own commands
                self.command.arguments,
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=subprocess.STDOUT,
                env=self._environment,
                start_new_session=True,
                preexec_fn=die_with_parent,
            )

    def send(self, number: signal.Signals) -> None:
        """Send a signal; nothing happens where the process has ended."""
        if self._popen is not None:
            self._popen.send_signal(number)
