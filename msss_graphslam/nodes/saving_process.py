# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The files of a live run written by a process of their own.

What writes and draws them is loaded there, while the back end smooths its scans, so it neither
takes the node's memory nor its time.
"""

import gc
import os
import pickle
import signal
import subprocess
import sys
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from msss_graphslam.core.types import Estimate
from msss_graphslam.errors import UserError
from msss_graphslam.nodes.live_run import LiveRun, Maps

__all__ = ["SavingProcess"]

_MODULE = "msss_graphslam.nodes.saving_process"

Progress = Callable[[float, str], object]
Complain = Callable[[str], object]


class SavingProcess:
    """A context manager: the process starts with it and makes ready, and ends with it.

    ``recording`` is the bag that was replayed, '' for none; ``complain`` is told where it cannot
    be used.
    """

    def __init__(self, recording: str, complain: Complain) -> None:
        self._recording = recording
        self._complain = complain

    def __enter__(self) -> Self:
        """Start the process."""
        # Whoever wants this process to end by Ctrl-C has not meant the one that writes.
        self._process = subprocess.Popen(  # noqa: S603
            [sys.executable, "-m", _MODULE, self._recording],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            start_new_session=True,
        )
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """End the process and its copies, whether they are through or not."""
        with suppress(ProcessLookupError):
            os.killpg(self._process.pid, signal.SIGKILL)
        for pipe in (self._process.stdin, self._process.stdout):
            with suppress(BrokenPipeError):
                if pipe is not None:
                    pipe.close()
        self._process.wait()

    def save(self, result: Estimate, run: LiveRun, output: Path, progress: Progress) -> Maps:
        """Have all files written; return the maps. Raises UserError where that cannot be.

        Nothing is lost where the process has failed, whatever it was: then they are written here.
        """
        try:
            return self._asked((result, run, output), progress)
        except (OSError, EOFError, pickle.PickleError, ImportError, AttributeError):
            from msss_graphslam.nodes.saving import Source, save

            return save(result, run, Source.of(self._recording, self._complain), output, progress)

    def _asked(self, task: tuple[Any, ...], progress: Progress) -> Maps:
        sending, receiving = self._process.stdin, self._process.stdout
        if sending is None or receiving is None:
            raise EOFError
        with sending:
            pickle.dump(task, sending)
        while True:
            kind, *values = pickle.load(receiving)  # noqa: S301 - of our own process
            if kind == "saved":
                maps: Maps = values[0]
                return maps
            if kind == "failed":
                raise UserError(*values)
            if kind == "complaint":
                self._complain(*values)
            else:
                progress(*values)


def _main(recording: str) -> None:
    from msss_graphslam.offline.beside import end_with_parent

    end_with_parent()
    gc.disable()  # It ends before its garbage matters.
    import msss_graphslam.evaluation.figures.plates  # noqa: F401 - in time
    from msss_graphslam.nodes.saving import Source, save

    # What others print must not come between the answers.
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)

    def answer(*values: object) -> None:
        pickle.dump(values, answers)
        answers.flush()

    source = Source.of(recording, lambda text: answer("complaint", text))
    result, run, output = pickle.load(sys.stdin.buffer)  # noqa: S301 - of our own process
    try:
        maps = save(result, run, source, output, lambda *told: answer("progress", *told))
    except UserError as error:
        answer("failed", str(error))
    else:
        answer("saved", maps)


if __name__ == "__main__":
    _main(sys.argv[1])
