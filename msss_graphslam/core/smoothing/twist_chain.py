# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What dead reckoning says of the scans' twist errors: a Gauss-Markov chain, scan by scan."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from msss_graphslam.core.scans.persistence import Persistence
from msss_graphslam.core.smoothing.normal_equations import NormalEquations
from msss_graphslam.core.types import Array, Scan

__all__ = ["Common", "TwistChain", "durations_of"]

LEAST_VARIANCE = 1e-12
"""Of a twist error that dead reckoning excludes [m^2/s^2, rad^2/s^2]."""


@dataclass(frozen=True, slots=True)
class Common:
    """What the chain says of p parameters that all twist errors depend on.

    Their ``information`` (p, p) and ``gradient`` (p,), and ``cross`` (3 n + 3, p), the information
    that they share with the n + 1 keyframes.
    """

    information: Array
    gradient: Array
    cross: Array


class TwistChain:
    """The prior of all scans' twist errors.

    ``durations`` (n,) [s] are the times from each scan to the next.
    """

    def __init__(self, scans: Sequence[Scan], persistence: Persistence) -> None:
        count = len(scans)
        self._before = np.maximum(np.arange(count) - 1, 0)
        spreads = _doubts(scans) + LEAST_VARIANCE * np.eye(3)
        self.durations = durations_of(scans)
        kept = [
            persistence.over(interval, spread)
            for interval, spread in zip(self.durations[:-1], spreads[1:], strict=True)
        ]
        self._kept = np.vstack([np.zeros(3), *kept])
        new = 1.0 - self._kept[:, :, None] * self._kept[:, None, :]
        self._information = np.linalg.inv(_steered(spreads) * new)

    def add_to(self, equations: NormalEquations, twists: Array, by_keyframes: Array) -> None:
        """Add what is known of the twist errors (n, 3).

        ``by_keyframes`` (n, 3, 6) derives them by the scan's own and the next keyframe.
        """
        errors, jacobian = self._linearised(twists, by_keyframes)
        weighted = np.swapaxes(jacobian, 1, 2) @ self._information
        equations.add(self._nodes(), weighted @ jacobian, (weighted @ errors[:, :, None])[:, :, 0])

    def common(self, twists: Array, by_keyframes: Array, basis: Array) -> Common:
        """Return what is known of parameters that add ``basis`` (n, 3, p) to the twist errors."""
        errors, jacobian = self._linearised(twists, by_keyframes)
        derivative = basis - self._kept[:, :, None] * basis[self._before]
        weighted = self._information @ derivative
        cross = np.zeros((len(twists) + 1, 3, basis.shape[2]))
        shared = np.swapaxes(jacobian, 1, 2) @ weighted
        np.add.at(cross, self._nodes(), shared.reshape(-1, 3, *cross.shape[1:]))
        return Common(
            np.einsum("nia,nib->ab", derivative, weighted),
            np.einsum("nia,ni->a", weighted, errors),
            cross.reshape(-1, basis.shape[2]),
        )

    def _linearised(self, twists: Array, by_keyframes: Array) -> tuple[Array, Array]:
        """Return what is new (n, 3) in each twist error, and its derivatives (n, 3, 9)."""
        jacobian = np.zeros((len(twists), 3, 9))
        jacobian[:, :, :6] = -self._kept[:, :, None] * by_keyframes[self._before]
        jacobian[:, :, 3:] += by_keyframes
        return twists - self._kept * twists[self._before], jacobian

    def _nodes(self) -> NDArray[np.intp]:
        own = np.arange(len(self._before))
        return np.column_stack([self._before, own, own + 1])


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


def _steered(doubts: Array) -> Array:
    """Return covariances (n, 3, 3) of twist errors in which sway is no surer than surge.

    A vehicle that keeps its line steers against what pushes it: turn after turn its heading is off
    its way by as much as it drifts aside. Taken for small and independent of the heading, sway
    would make slow motion likelier than it was, and a map too short where walls say little of the
    way along them.
    """
    surge, sway = doubts[:, 0, 0], doubts[:, 1, 1]
    wider = np.ones((len(doubts), 3))
    wider[:, 1] = np.sqrt(np.maximum(surge / sway, 1.0))
    return np.asarray(wider[:, :, None] * doubts * wider[:, None, :])
