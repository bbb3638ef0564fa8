# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The figures of a run drawn by two copies of this process, while it does something else."""

import ctypes
import os
import pickle
import signal
from collections.abc import Sequence
from itertools import chain, zip_longest
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from msss_graphslam.evaluation.assessment import Assessment
    from msss_graphslam.evaluation.pictures import Picture

__all__ = ["Drawing", "end_with_parent"]

_COPIES = 2

_SET_PARENT_DEATH_SIGNAL = 1
"""``PR_SET_PDEATHSIG`` of ``linux/prctl.h``."""


class Drawing:
    """Begins with its making; for processes without threads, as copies have none.

    Each copy draws every other figure. Copies that are not waited for end by themselves.
    """

    def __init__(self, assessment: "Assessment") -> None:
        import msss_graphslam.evaluation.figures.plates  # noqa: F401 - once for all copies

        self._assessment = assessment
        self._copies = [_Copy(assessment, number) for number in range(_COPIES)]

    def pictures(self) -> "list[Picture]":
        """Return the figures; where a copy has failed, its share is drawn here."""
        shares = [
            _share(self._assessment, number) if drawn is None else drawn
            for number, drawn in enumerate([copy.pictures() for copy in self._copies])
        ]
        in_turn = chain.from_iterable(zip_longest(*shares))
        return [picture for picture in in_turn if picture is not None]


class _Copy:
    """A forked process that draws its share."""

    def __init__(self, assessment: "Assessment", number: int) -> None:
        receiving, sending = os.pipe()
        self._pid = os.fork()
        if not self._pid:
            os.close(receiving)
            _draw_and_end(assessment, number, sending)
        os.close(sending)
        self._receiving = receiving

    def pictures(self) -> "Sequence[Picture | None] | None":
        """Return what it has drawn, or None where it has failed."""
        with os.fdopen(self._receiving, "rb") as pipe:
            try:
                drawn: Sequence[Picture | None] = pickle.load(pipe)  # noqa: S301 - our own process
            except (EOFError, pickle.UnpicklingError):
                return None
            finally:
                os.waitpid(self._pid, 0)
        return drawn


def end_with_parent() -> None:
    """Have the kernel kill this process with the one that has started it."""
    ctypes.CDLL(None).prctl(_SET_PARENT_DEATH_SIGNAL, int(signal.SIGKILL), 0, 0, 0)


def _draw_and_end(assessment: "Assessment", number: int, sending: int) -> None:
    """Draw in a copy, which must never return into the work of what it was copied from."""
    try:
        end_with_parent()
        with os.fdopen(sending, "wb") as pipe:
            pickle.dump(_share(assessment, number), pipe)
    finally:
        os._exit(0)


def _share(assessment: "Assessment", number: int) -> "list[Picture | None]":
    from msss_graphslam.evaluation.pictures import picture_count, run_picture

    return [run_picture(assessment, each) for each in range(number, picture_count(), _COPIES)]
