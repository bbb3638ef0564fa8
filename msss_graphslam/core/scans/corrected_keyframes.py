# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Keyframes whose scans are laid out by the trajectory; those of a day when they are asked for."""

from collections.abc import Sequence
from typing import overload

from msss_graphslam.core.compounding import between_covariance
from msss_graphslam.core.scans.scan_correction import corrected_scan
from msss_graphslam.core.scans.trajectory_correction import Solver
from msss_graphslam.core.types import Array, Keyframe, Scan, TwistError

__all__ = ["CorrectedKeyframes", "corrected_keyframes"]

KEPT = 1024
"""So many keyframes are laid out for good: maps and figures ask for them again and again."""


class CorrectedKeyframes(Sequence[Keyframe]):
    """Keyframes, each with its scan made anew whenever it is asked for.

    ``scans`` are as dead reckoning laid them out, ``poses`` (n, 3) and ``covariances`` n times
    (3, 3) those of the keyframes; ``solver`` and ``known`` as in ``corrected_scan``. Of these only
    the ``numbers`` are members, all where None.
    """

    def __init__(
        self,
        scans: Sequence[Scan],
        poses: Array,
        covariances: Sequence[Array],
        solver: Solver,
        known: TwistError | None,
        numbers: range | None = None,
    ) -> None:
        if not len(scans) == len(poses) == len(covariances):
            raise ValueError(
                f"{len(scans)} scans, {len(poses)} poses, {len(covariances)} covariances"
            )
        self._covariances = covariances
        self._given = scans, poses, solver, known
        self._numbers = range(len(poses)) if numbers is None else numbers

    def __len__(self) -> int:
        return len(self._numbers)

    @overload
    def __getitem__(self, place: int) -> Keyframe: ...

    @overload
    def __getitem__(self, place: slice) -> "CorrectedKeyframes": ...

    def __getitem__(self, place: int | slice) -> "Keyframe | CorrectedKeyframes":
        scans, poses, solver, known = self._given
        if isinstance(place, slice):
            chosen = self._numbers[place]
            return CorrectedKeyframes(scans, poses, self._covariances, solver, known, chosen)
        number = self._numbers[place]
        scan = corrected_scan(number, scans, poses, solver, known, self._spread(number))
        return Keyframe(scan, poses[number], self._covariances[number])

    def _spread(self, number: int) -> Array | None:
        """Return how well the displacement of the following keyframe is known (3, 3), if it is.

        At most as badly as if the errors of both keyframes had nothing in common.
        """
        _, poses, _, known = self._given
        if known is None or number + 1 == len(poses):
            return None
        both = self._covariances[number], self._covariances[number + 1]
        return between_covariance(poses[number], both[0], poses[number + 1], both[1])


def corrected_keyframes(
    scans: Sequence[Scan],
    poses: Array,
    covariances: Sequence[Array],
    solver: Solver,
    known: TwistError | None,
) -> Sequence[Keyframe]:
    """Return the keyframes as in ``CorrectedKeyframes``; a few hundred of them laid out at once.

    The layout takes as much memory again as what was measured.
    """
    frames = CorrectedKeyframes(scans, poses, covariances, solver, known)
    return tuple(frames) if len(frames) <= KEPT else frames
