# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What dead reckoning says of the scans' twist errors: a Gauss-Markov chain, scan by scan."""

from collections.abc import Sequence

import numpy as np

from msss_graphslam.core.scans.motion_feedback import Persistence
from msss_graphslam.core.smoothing.normal_equations import NormalEquations
from msss_graphslam.core.types import Array, Scan

__all__ = ["TwistChain", "durations_of"]

LEAST_VARIANCE = 1e-12
"""Of a twist error that dead reckoning excludes [m^2/s^2, rad^2/s^2]."""


class TwistChain:
    """The prior of all scans' twist errors."""

    def __init__(self, scans: Sequence[Scan], persistence: Persistence) -> None:
        count = len(scans)
        self._before = np.maximum(np.arange(count) - 1, 0)
        spreads = _doubts(scans) + LEAST_VARIANCE * np.eye(3)
        kept = [
            persistence.over(interval, spread)
            for interval, spread in zip(durations_of(scans)[:-1], spreads[1:], strict=True)
        ]
        self._kept = np.vstack([np.zeros(3), *kept])
        new = 1.0 - self._kept[:, :, None] * self._kept[:, None, :]
        self._information = np.linalg.inv(spreads * new)

    def add_to(self, equations: NormalEquations, twists: Array, by_keyframes: Array) -> None:
        """Add what is known of the twist errors (n, 3).

        ``by_keyframes`` (n, 3, 6) derives them by the scan's own and the next keyframe.
        """
        errors = twists - self._kept * twists[self._before]
        jacobian = np.zeros((len(twists), 3, 9))
        jacobian[:, :, :6] = -self._kept[:, :, None] * by_keyframes[self._before]
        jacobian[:, :, 3:] += by_keyframes
        weighted = np.swapaxes(jacobian, 1, 2) @ self._information
        own = np.arange(len(twists))
        equations.add(
            np.column_stack([self._before, own, own + 1]),
            weighted @ jacobian,
            (weighted @ errors[:, :, None])[:, :, 0],
        )


def durations_of(scans: Sequence[Scan]) -> Array:
    """Return the seconds (n,) from each scan to the next, of the last one to its end."""
    stamps = [scan.stamp_ns for scan in scans] + [scans[-1].end_stamp_ns]
    return np.asarray(np.maximum(np.diff(stamps) * 1e-9, 1e-3))


def _doubts(scans: Sequence[Scan]) -> Array:
    """Return the covariances (n, 3, 3) of the twist errors.

    Of a scan that was lost on its way only the pose is left; it is as doubtful as any.
    """
    known = np.array([scan.twist_covariance for scan in scans])
    widest = known[np.argmax(np.trace(known, axis1=1, axis2=2))]
    reckoned = np.any(known, axis=(1, 2), keepdims=True)
    return np.asarray(np.where(reckoned, known, widest))
