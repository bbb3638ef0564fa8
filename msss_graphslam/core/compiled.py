# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Loops over plain numbers, compiled at their first call and kept for the next process.

Modules of such loops are imported where they are called: the compiler takes a node half a second
and 100 MiB, and not every node has something to match. Within them no array is an operand, only
its elements are: NumPy's functions take seconds to compile. Loops that call each other stand in
one file, and take what others define as arguments: what was kept counts as outdated when its own
file has changed, and then only.
"""

from collections.abc import Callable
from typing import Any, TypeVar, cast

from numba import njit

__all__ = ["compiled"]

Loop = TypeVar("Loop", bound=Callable[..., Any])


def compiled(function: Loop) -> Loop:
    """Return the function compiled; it may call others that are."""
    try:
        return cast(Loop, njit(cache=True)(function))
    except RuntimeError:
        # Nowhere to keep it: each process compiles for itself.
        return cast(Loop, njit(function))
