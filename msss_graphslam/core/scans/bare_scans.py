# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Scans without their layout, which takes as much memory again and is soon made anew."""

from collections.abc import Sequence
from dataclasses import replace
from typing import overload

import numpy as np

from msss_graphslam.core.scans.scan_generation import lay_out
from msss_graphslam.core.types import Scan

__all__ = ["LaidOut", "bare"]


def bare(scan: Scan) -> Scan:
    """Return what was measured, with the motion; the layout is that of a vehicle at rest."""
    # The two columns alone, not the three of which they may be a part.
    points = scan.body_points.copy()
    return replace(
        scan,
        motion_covariances=np.empty((0, 3, 3)),
        body_points=points,
        points=points,
        covariances=scan.body_covariances,
    )


class LaidOut(Sequence[Scan]):
    """Bare scans, each laid out by its own motion when it is asked for."""

    def __init__(self, scans: Sequence[Scan]) -> None:
        self._scans = scans

    def __len__(self) -> int:
        return len(self._scans)

    @overload
    def __getitem__(self, place: int) -> Scan: ...

    @overload
    def __getitem__(self, place: slice) -> "LaidOut": ...

    def __getitem__(self, place: int | slice) -> "Scan | LaidOut":
        if isinstance(place, slice):
            return LaidOut(self._scans[place])
        scan = self._scans[place]
        return lay_out(scan, scan.motion, scan.twist_covariance)
