# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""One session: processes started, watched until it is over, asked to save, ended."""

import re
import time
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass
from pathlib import Path

from msss_graphslam.errors import UserError
from msss_graphslam.live.interruption import Interruption
from msss_graphslam.live.process import Command
from msss_graphslam.live.supervisor import LOOK_EVERY, Say, Supervisor

__all__ = ["Conclude", "Outcome", "Progress", "run_session"]

Progress = Callable[[float, str], None]
"""Takes the finished fraction, 0 to 1, and what is being done."""

Conclude = Callable[[Sequence[str], Progress], dict[str, str]]
"""Has the named processes save, in this order; returns what each said in the end."""

_RUNNING = 0.8
"""Share of a session, as its progress shows it; the rest is for its end."""

_ENDING = "ending: all is worked off and written first; a second Ctrl-C ends without"

_SHARE = re.compile(r"replayed (\d+) %")
"""What the replay says at each tenth."""

_SAVED = re.compile(r"saving (\d+) %: (.+)")
"""What the last of those that save says."""


@dataclass(frozen=True, slots=True)
class Outcome:
    """How a session went: who failed for good and why, who came back how often, who said what."""

    failed: dict[str, str]
    restarts: dict[str, int]
    answers: dict[str, str]


def run_session(
    commands: Sequence[Command],
    logs: Path,
    *,
    saving: Sequence[str],
    until: str | None,
    concluding: AbstractContextManager[Conclude],
    say: Say,
    progress: Progress,
) -> Outcome:
    """Run the commands until the one named ``until`` has ended, or a signal comes; then save.

    ``concluding`` is entered when they have been started: at the end nobody has to wait for it. It
    is over as well when one of those that take part in ``saving`` cannot be kept running. All
    processes have ended when this returns or raises. Raises KeyboardInterrupt on a second signal,
    UserError where the last of ``saving`` is gone.
    """
    session = _Session(commands, logs, saving, until, say, progress)
    with Interruption() as interruption:
        try:
            session.supervisor.start()
            with concluding as conclude:
                session.watch(interruption)
                if interruption.wished:
                    say(_ENDING)
                answers = session.save(conclude)
        except KeyboardInterrupt:
            interruption.deaf = True
            session.tell("ending at once")
            session.supervisor.stop_at_once()
            raise
        finally:
            interruption.deaf = True
            session.supervisor.stop()
    progress(1.0, "done")
    return Outcome(session.supervisor.failed, session.supervisor.restarts, answers)


class _Session:
    """The processes of a session and how far it is."""

    def __init__(
        self,
        commands: Sequence[Command],
        logs: Path,
        saving: Sequence[str],
        until: str | None,
        say: Say,
        progress: Progress,
    ) -> None:
        self.supervisor = Supervisor(commands, logs, say, heard=self._hear)
        self._saving = saving
        self._until = until
        self._progress = progress
        self._share = self._saved = self._asked = 0.0
        self._saving_what = ""

    def watch(self, interruption: Interruption) -> None:
        """Look at the processes until the session is over."""
        doing = f"{self._until} running" if self._until else "running until Ctrl-C"
        while not (interruption.wished or self._is_over()):
            self.supervisor.look()
            self._progress(_RUNNING * self._share, doing)
            time.sleep(LOOK_EVERY)
        self.supervisor.look()

    def save(self, conclude: Conclude) -> dict[str, str]:
        """Have those that still run save; nothing can be saved without the last of them."""
        if self._until is not None:
            self.supervisor.stop(self._until)
        names = [name for name in self._saving if name not in self.supervisor.failed]
        writer = self._saving[-1]
        if writer not in names:
            raise UserError(f"nothing written, {writer}: {self.supervisor.failed[writer]}")
        return conclude(names, self._save_progress)

    def tell(self, what: str) -> None:
        """Show what is being done after the nodes' work."""
        done = max(self._saved, self._asked)
        self._progress(_RUNNING + (1.0 - _RUNNING) * done, what)

    def _is_over(self) -> bool:
        if any(name in self.supervisor.failed for name in self._saving):
            return True
        return self._until is not None and self.supervisor.exit_code(self._until) is not None

    def _save_progress(self, share: float, what: str) -> None:
        """Show how far saving is; who dies meanwhile is started again."""
        self.supervisor.look()
        self._asked = share
        self.tell(f"saving {self._saving_what or what}".rstrip())

    def _hear(self, name: str, line: str) -> None:
        if name == self._until and (found := _SHARE.search(line)):
            self._share = min(int(found[1]) / 100, 1.0)
        if name == self._saving[-1] and (found := _SAVED.search(line)):
            self._saved, self._saving_what = min(int(found[1]) / 100, 1.0), found[2]
