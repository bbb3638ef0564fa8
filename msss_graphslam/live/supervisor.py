# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Several processes watched: the dead started again, all of them ended in order."""

import os
import signal
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from msss_graphslam.live.log_tail import LogTail, warning_in
from msss_graphslam.live.process import Command, Process
from msss_graphslam.live.restarts import Restarts

__all__ = ["LOOK_EVERY", "Say", "Supervisor", "describe_end"]

Say = Callable[[str], None]

LOOK_EVERY = 0.05
"""Time between two looks at the processes [s]."""

_WAIT = 0.01
"""Time between two looks at processes that have been told to end [s]."""

_FAREWELLS = ((signal.SIGINT, 3.0), (signal.SIGTERM, 0.5), (signal.SIGKILL, 2.0))
_HASTY_FAREWELLS = ((signal.SIGINT, 0.5), (signal.SIGKILL, 2.0))
"""What is sent to a process that shall end, and how long each is waited for [s]."""

_ENVIRONMENT = {"PYTHONUNBUFFERED": "1", "OMP_NUM_THREADS": "1"}
"""Lines reach the logs at once; the processes share the cores, so none spreads over them all."""


class Supervisor:
    """Starts commands, keeps them running, tells what they complain of, and ends them.

    Used from one thread that outlives all processes: the kernel ends a child with the thread
    that started it.

    Attributes
    ----------
    failed
        Why, for each process that died and does not come back.
    """

    def __init__(
        self,
        commands: Sequence[Command],
        logs: Path,
        say: Say,
        *,
        heard: Callable[[str, str], None] | None = None,
        environment: Mapping[str, str] | None = None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        logs.mkdir(parents=True, exist_ok=True)
        inherited = os.environ if environment is None else environment
        self.failed: dict[str, str] = {}
        self._say = say
        self._heard = heard
        self._clock = clock
        self._watched = [
            _Watched(command, logs / f"{command.name}.log", {**_ENVIRONMENT, **inherited})
            for command in commands
        ]

    @property
    def running(self) -> list[str]:
        """The names of the processes that run now."""
        return [watched.name for watched in self._watched if watched.process.is_running]

    @property
    def restarts(self) -> dict[str, int]:
        """How often each process was started again, without those that never were."""
        return {each.name: each.restarts.count for each in self._watched if each.restarts.count}

    def exit_code(self, name: str) -> int | None:
        """Return how a process ended, or None while it runs."""
        return next(each.process.exit_code for each in self._watched if each.name == name)

    def start(self) -> None:
        """Start every process, in the order of the commands."""
        for watched in self._watched:
            watched.process.start()

    def look(self) -> None:
        """Look once at every process: what it says, whether it lives, whether it is due again."""
        for watched in self._watched:
            self._listen(watched)
            if watched.has_just_ended():
                self._listen(watched)
                self._mourn(watched)
            if not watched.is_leaving and watched.restarts.take(self._clock()):
                watched.start_again()

    def stop(self, *names: str) -> None:
        """End the named processes, or all: by SIGINT, then by SIGTERM, at last by SIGKILL."""
        leaving = [each for each in self._watched if not names or each.name in names]
        self._dismiss(leaving, _FAREWELLS, self._say)
        for watched in leaving:
            self._listen(watched)

    def stop_at_once(self) -> None:
        """End all processes, those that are busy by SIGKILL, and listen to none."""
        self._dismiss(self._watched, _HASTY_FAREWELLS, lambda _: None)

    def _dismiss(
        self,
        leaving: Sequence["_Watched"],
        farewells: Sequence[tuple[signal.Signals, float]],
        say: Say,
    ) -> None:
        for watched in leaving:
            watched.is_leaving = True
        for number, lasting in farewells:
            left = [watched for watched in leaving if watched.process.is_running]
            for watched in left:
                if number is not signal.SIGINT:
                    say(f"{watched.name}: does not end, sent {number.name}")
                watched.process.send(number)
            self._wait_for(left, lasting)

    def _wait_for(self, leaving: Sequence["_Watched"], patience: float) -> None:
        until = time.monotonic() + patience
        while any(each.process.is_running for each in leaving) and time.monotonic() < until:
            time.sleep(_WAIT)

    def _listen(self, watched: "_Watched") -> None:
        for line in watched.tail.lines():
            if self._heard is not None:
                self._heard(watched.name, line)
            warning = warning_in(line)
            if warning is not None:
                self._say(f"{watched.name}: {warning}")

    def _mourn(self, watched: "_Watched") -> None:
        """Have a dead process come back, or note why it does not."""
        code = watched.process.exit_code or 0
        if not watched.process.command.returns:
            if code:
                self._give_up(watched, f"{describe_end(code)}{watched.last_words}")
        elif watched.restarts.died(self._clock()):
            self._say(f"{watched.name}: {describe_end(code)}, started again")
        else:
            self._give_up(watched, f"{describe_end(code)} too often{watched.last_words}")

    def _give_up(self, watched: "_Watched", reason: str) -> None:
        self.failed[watched.name] = f"{reason} (see {watched.process.log})"
        self._say(f"{watched.name}: {self.failed[watched.name]}")


def describe_end(code: int) -> str:
    """Return in words how a process ended."""
    if code >= 0:
        return f"ended with exit code {code}"
    return f"ended by signal {-code} ({signal.strsignal(-code)})"


class _Watched:
    """A process with its log and its deaths."""

    def __init__(self, command: Command, log: Path, environment: Mapping[str, str]) -> None:
        log.write_bytes(b"")
        self.name = command.name
        self.process = Process(command, log, environment)
        self.tail = LogTail(log)
        self.restarts = Restarts()
        self.is_leaving = False
        self._end_is_known = False

    @property
    def last_words(self) -> str:
        """The last line of the log, to be put after how the process ended."""
        return f": {self.tail.last}" if self.tail.last else ""

    def has_just_ended(self) -> bool:
        """Return True once for each end that nobody asked for."""
        if self.is_leaving or self._end_is_known or self.process.exit_code is None:
            return False
        self._end_is_known = True
        return True

    def start_again(self) -> None:
        self._end_is_known = False
        self.process.start()
