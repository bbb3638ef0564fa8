# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""How far a node's long work is, told at each tenth. No ROS."""

from collections.abc import Callable

__all__ = ["Tenths"]


class Tenths:
    """Says ``saving 40 %: joint smoothing``, once for each tenth and each thing that is done."""

    def __init__(self, say: Callable[[str], object]) -> None:
        self._say = say
        self._told = (-1, "")

    def __call__(self, share: float, what: str) -> None:
        """Note how far the work is, 0 to 1, and what is being done."""
        now = (int(10.0 * share), what)
        if now != self._told:
            self._told = now
            self._say(f"saving {10 * now[0]} %: {what}")
