# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""A scan bent so that it ends at the next keyframe, and how its points move with its twist."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from msss_graphslam.core.compounding import between, rotation, transform_points
from msss_graphslam.core.matching.line_features import LineFeatures, line_features
from msss_graphslam.core.matching.plane_vectors import Numbers, Vectors, vectors
from msss_graphslam.core.scans.trajectory_correction import closed_form, correct_motion
from msss_graphslam.core.types import Array, Scan

__all__ = ["BentScan", "Hanging", "bend", "reckoned_ends"]


@dataclass(frozen=True, slots=True)
class Hanging:
    """How places in the scan's frame move with its twist error, each hanging on a beam.

    A change u + i v of the translation and w of the rotation moves the place p by
    ``drift`` (u + i v) + (``swing`` + i ``elapsed`` p) w; all (n,), in s, m s and s.
    """

    drift: Vectors
    swing: Vectors
    elapsed: Array

    @staticmethod
    def together(several: Sequence["Hanging"]) -> "Hanging":
        """Return one after the other."""
        return Hanging(
            np.concatenate([one.drift for one in several]),
            np.concatenate([one.swing for one in several]),
            np.concatenate([one.elapsed for one in several]),
        )

    def at(self, chosen: Numbers) -> "Hanging":
        """Return the same of the places chosen."""
        return Hanging(self.drift[chosen], self.swing[chosen], self.elapsed[chosen])

    def along(self, normals: Vectors, places: Vectors) -> Array:
        """Return how far (n, 3) the places move along normals, by surge, sway and yaw rate."""
        translated = np.conj(normals) * self.drift
        turned = np.real(np.conj(normals) * (self.swing + 1j * self.elapsed * places))
        return np.column_stack([translated.real, -translated.imag, turned])


@dataclass(frozen=True, slots=True)
class BentScan:
    """A scan laid out, in the frame of its keyframe, so that it ends at the next.

    ``relative`` (3,) is the next keyframe in that frame; ``twist`` (3,) is what has to be added to
    the reckoned surge, sway [m/s] and yaw rate [rad/s] for it, ``twist_by_relative`` (3, 3) its
    derivative. ``lines`` (n) are the local lines, None with too few points, ``lines_hanging``
    says how they move; of the m points on a line ``points``, ``normals`` and ``covariances``
    (m, 2, 2), the sonar's noise alone, and ``points_hanging``.
    """

    relative: Array
    twist: Array
    twist_by_relative: Array
    lines: LineFeatures | None
    lines_hanging: Hanging
    points: Vectors
    normals: Vectors
    covariances: Array
    points_hanging: Hanging


def reckoned_ends(scans: Sequence[Scan]) -> list[Array]:
    """Return the next keyframe (3,) by dead reckoning in each scan, at last the end."""
    ends = [scan.odometry for scan in scans[1:]]
    ends += [scan.reckoned[-1, [0, 1, 5]] for scan in scans[-1:]]
    return [between(scan.odometry, end) for scan, end in zip(scans, ends, strict=True)]


def bend(scan: Scan, reckoned_end: Array, relative: Array, duration: float) -> BentScan:
    """Lay out a scan such that the next keyframe is at ``relative`` (3,) in its frame.

    ``reckoned_end`` (3,) is where dead reckoning has that keyframe, ``duration`` [s] later. The
    correction is that of equation 14, the same at every beam.
    """
    correction = correct_motion(scan.motion, reckoned_end, relative, closed_form)
    by_twist = _by_twist(np.vstack([correction.poses, relative]), duration)
    hanging = _hanging(correction.poses, by_twist).at(scan.beam_index)
    at_hits = correction.poses[scan.beam_index]
    points, turns = transform_points(at_hits, scan.body_points), rotation(at_hits[:, 2])
    covariances = turns @ scan.body_covariances @ np.swapaxes(turns, -1, -2)
    lines = line_features(points, covariances)
    flat = np.flatnonzero(lines.flat) if lines else np.empty(0, dtype=np.intp)
    return BentScan(
        relative=relative,
        twist=correction.delta * len(scan.motion) / duration,
        twist_by_relative=np.linalg.inv(by_twist[-1]),
        lines=lines,
        lines_hanging=hanging,
        points=vectors(points[flat]),
        normals=vectors(lines.normals[flat]) if lines else np.empty(0, dtype=complex),
        covariances=covariances[flat],
        points_hanging=hanging.at(flat),
    )


def _by_twist(motion: Array, duration: float) -> Array:
    """Return the derivatives (n, 3, 3) of the motion (n, 3) by a constant twist error.

    Equation 14 gives every step between beams the same share, whatever time it takes.
    """
    elapsed = np.linspace(0.0, duration, len(motion))
    steps = np.diff(motion, axis=0, prepend=motion[:1])
    derivative = np.zeros((len(motion), 3, 3))
    share = np.where(elapsed > 0.0, duration / (len(motion) - 1), 0.0)
    derivative[:, :2, :2] = np.cumsum(rotation(motion[:, 2]) * share[:, None, None], axis=0)
    derivative[:, 0, 2] = np.cumsum(-steps[:, 1] * elapsed)
    derivative[:, 1, 2] = np.cumsum(steps[:, 0] * elapsed)
    derivative[:, 2, 2] = elapsed
    return derivative


def _hanging(motion: Array, by_twist: Array) -> Hanging:
    """Return how places move that hang on the beams at ``motion`` (b, 3)."""
    by_twist = by_twist[: len(motion)]
    elapsed = by_twist[:, 2, 2]
    swing = vectors(by_twist[:, :, 2]) - 1j * elapsed * vectors(motion)
    return Hanging(vectors(by_twist[:, :, 0]), swing, elapsed)
