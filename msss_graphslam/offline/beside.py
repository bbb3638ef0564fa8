# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Work done by a copy of this process, while it does something else."""

import ctypes
import gc
import os
import pickle
import signal
from collections.abc import Callable
from typing import Generic, TypeVar

__all__ = ["Beside", "end_with_parent"]

_SET_PARENT_DEATH_SIGNAL = 1
"""``PR_SET_PDEATHSIG`` of ``linux/prctl.h``."""

_Result = TypeVar("_Result")


class Beside(Generic[_Result]):
    """Begins with its making; for processes without threads, as copies have none.

    A copy that is not waited for ends by itself.
    """

    def __init__(self, work: Callable[[], _Result]) -> None:
        self._work = work
        receiving, sending = os.pipe()
        self._pid = os.fork()
        if not self._pid:
            os.close(receiving)
            self._work_and_end(sending)
        os.close(sending)
        self._receiving = receiving

    def result(self) -> _Result:
        """Return what came out, once; where the copy has failed, the work is done here."""
        with os.fdopen(self._receiving, "rb") as pipe:
            try:
                result: _Result = pickle.load(pipe)  # noqa: S301 - of our own process
            except (EOFError, pickle.UnpicklingError):
                return self._work()
            finally:
                os.waitpid(self._pid, 0)
        return result

    def _work_and_end(self, sending: int) -> None:
        """Work in a copy, which must never return into what it was copied from."""
        try:
            end_with_parent()
            gc.disable()  # It ends before its garbage matters.
            with os.fdopen(sending, "wb") as pipe:
                pickle.dump(self._work(), pipe)
        finally:
            os._exit(0)


def end_with_parent() -> None:
    """Have the kernel kill this process with the one that has started it."""
    ctypes.CDLL(None).prctl(_SET_PARENT_DEATH_SIGNAL, int(signal.SIGKILL), 0, 0, 0)
