# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The figures of a run drawn by two copies of this process, while it does something else."""

from functools import partial
from itertools import chain, zip_longest
from typing import TYPE_CHECKING

from msss_graphslam.offline.beside import Beside

if TYPE_CHECKING:
    from msss_graphslam.evaluation.assessment import Assessment
    from msss_graphslam.evaluation.pictures import Picture

__all__ = ["Drawing"]

_COPIES = 2


class Drawing:
    """Begins with its making; each copy draws every other figure."""

    def __init__(self, assessment: "Assessment") -> None:
        import msss_graphslam.evaluation.figures.plates  # noqa: F401 - once for all copies

        self._copies = [Beside(partial(_share, assessment, number)) for number in range(_COPIES)]

    def pictures(self) -> "list[Picture]":
        """Return the figures in their order."""
        in_turn = chain.from_iterable(zip_longest(*(copy.result() for copy in self._copies)))
        return [picture for picture in in_turn if picture is not None]


def _share(assessment: "Assessment", number: int) -> "list[Picture | None]":
    from msss_graphslam.evaluation.pictures import picture_count, run_picture

    return [run_picture(assessment, each) for each in range(number, picture_count(), _COPIES)]
