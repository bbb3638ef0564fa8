# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Which scans joint smoothing aligns, what they count, and how far apart it looks at first."""

from collections import Counter
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from msss_graphslam.core.scans.scan_generation import motion_covariances, reckoned_motion
from msss_graphslam.core.types import Array, Constraint, ConstraintKind, Scan

__all__ = ["first_reach", "pairs_of", "weights_of"]


def pairs_of(constraints: Sequence[Constraint], enough: int) -> list[tuple[int, int]]:
    """Return the pairs of scans that are to be aligned, sorted.

    Consecutive scans and accepted loops; between scans that have not ``enough`` accepted partners,
    also those near enough that were refused: where yaw is badly known, shapes differ and rigid
    scans do not fit, although the place is the same.
    """
    tried = [entry for entry in constraints if entry.kind is not ConstraintKind.ODOMETRY]
    partners = Counter(
        number for entry in tried if entry.accepted for number in (entry.first, entry.second)
    )
    return sorted(
        {
            (entry.first, entry.second)
            for entry in tried
            if entry.accepted
            or entry.kind is ConstraintKind.CONSECUTIVE
            or max(partners[entry.first], partners[entry.second]) < enough
        }
    )


def weights_of(pairs: NDArray[np.intp], count: int) -> Array:
    """Return what each of the ``pairs`` (p, 2) counts (p,).

    The noise of its scans is in all their other pairs as well. K scans of one wall make
    K (K - 1) / 2 pairs; at 2 / K each they say of a scan's place what its own noise and a wall
    known by the others allow, and no more.
    """
    partners = np.bincount(pairs.ravel(), minlength=count)
    return np.asarray(2.0 / (1.0 + 0.5 * partners[pairs].sum(axis=1)))


def first_reach(scans: Sequence[Scan], constraints: Sequence[Constraint], narrow: float) -> float:
    """Return how far apart [m] points of consecutive scans may be before they are aligned.

    ``narrow`` [m] for a scan whose successor has been matched, three standard deviations of dead
    reckoning for another; the median over all scans, so that a few refused ones change nothing.
    """
    matched = {
        entry.first
        for entry in constraints
        if entry.accepted and entry.kind is ConstraintKind.CONSECUTIVE
    }
    reaches = [
        narrow if number in matched else max(narrow, 3.0 * _deviation(scan))
        for number, scan in enumerate(scans[:-1])
    ]
    return float(np.median(reaches)) if reaches else narrow


def _deviation(scan: Scan) -> float:
    """Return the largest standard deviation [m] of the way reckoned within a scan."""
    motion = reckoned_motion(scan.reckoned)
    spread = motion_covariances(motion, scan.beam_times, scan.twist_covariance)[-1]
    return float(np.sqrt(max(np.linalg.eigvalsh(spread[:2, :2])[-1], 0.0)))
