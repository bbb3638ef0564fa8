# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The figures of a run drawn by a process of their own, while the run's files are written.

What draws them is loaded there, too, so it neither takes this process' memory nor its time.
"""

import pickle
import subprocess
import sys
from threading import Thread
from types import TracebackType
from typing import TYPE_CHECKING, Self

if TYPE_CHECKING:
    from msss_graphslam.evaluation.assessment import Assessment
    from msss_graphslam.evaluation.pictures import Picture

__all__ = ["Drawing"]

_LONGEST = 120.0
_MODULE = "msss_graphslam.offline.drawing"


class Drawing:
    """A context manager: the process starts with it and makes ready, and ends with it."""

    def __enter__(self) -> Self:
        """Start the process."""
        self._drawn: list[Picture] | None = None
        self._assessment: Assessment | None = None
        self._thread: Thread | None = None
        # Whoever wants this process to end by Ctrl-C has not meant the one that draws.
        self._process = subprocess.Popen(  # noqa: S603
            [sys.executable, "-m", _MODULE],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
        )
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """End the process, whether it is through or not."""
        self._process.kill()
        if self._thread is not None:
            self._thread.join()
        else:
            self._process.communicate()

    def begin(self, assessment: "Assessment") -> None:
        """Have the figures drawn."""
        self._assessment = assessment
        self._thread = Thread(target=self._draw, args=[pickle.dumps(assessment)], daemon=True)
        self._thread.start()

    def pictures(self) -> "list[Picture]":
        """Return the figures of what was begun; where the process has failed, draw them here."""
        if self._thread is None or self._assessment is None:
            raise ValueError("no drawing has been begun")
        self._thread.join()
        if self._drawn is None:
            from msss_graphslam.evaluation.pictures import run_pictures

            self._drawn = run_pictures(self._assessment)
        return self._drawn

    def _draw(self, task: bytes) -> None:
        try:
            answer, _ = self._process.communicate(task, timeout=_LONGEST)
            self._drawn = pickle.loads(answer)  # noqa: S301 - of our own process
        except Exception:
            # No figure is lost by it, whatever it was: it is drawn here.
            self._process.kill()


def _main() -> None:
    import msss_graphslam.evaluation.figures.plates  # noqa: F401 - in time
    from msss_graphslam.evaluation.pictures import run_pictures

    assessment = pickle.load(sys.stdin.buffer)  # noqa: S301 - of our own process
    pickle.dump(run_pictures(assessment), sys.stdout.buffer)


if __name__ == "__main__":
    _main()
