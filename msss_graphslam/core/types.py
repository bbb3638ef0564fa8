# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The records that flow through the package: measurements in, scans, constraints and poses out.

Units are SI, angles radians, stamps integer nanoseconds of acquisition. A planar pose is a row
(x, y, yaw). Frames follow REP-103 and REP-105: ENU, z up, yaw counter-clockwise.
"""

from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "Array",
    "Beam",
    "BodyVelocity",
    "Constraint",
    "ConstraintKind",
    "Depth",
    "Estimate",
    "GraphPoses",
    "Inertial",
    "Keyframe",
    "KeyframeReport",
    "MapCorrection",
    "Measurement",
    "Odometry",
    "Reading",
    "Scan",
    "SonarCalibration",
    "Stage",
    "Stamps",
    "Trajectory",
    "TwistError",
]

Array = NDArray[np.float64]
Stamps = NDArray[np.int64]
Stage = Callable[[str], AbstractContextManager[object]]
"""Encloses the work of a named stage, so that a caller can measure its time."""


@dataclass(frozen=True, slots=True)
class Beam:
    """One echo profile as the head sent it.

    ``bearing`` [rad] is counter-clockwise in ``sonar_link``; ``ranges`` (n,) are the bins' centres
    [m]; ``intensities`` (n,) the codes 0..255.
    """

    stamp_ns: int
    bearing: float
    ranges: Array
    intensities: Array


@dataclass(frozen=True, slots=True)
class Inertial:
    """One IMU sample; what the sensor does not give is None (REP-145).

    ``orientation`` (3,) is roll, pitch, yaw of ``base_link`` in ENU [rad]; ``angular_velocity``
    (3,) is in ``base_link`` [rad/s].
    """

    stamp_ns: int
    orientation: Array | None
    angular_velocity: Array | None


@dataclass(frozen=True, slots=True)
class Depth:
    """Vertical position from the pressure sensor: ``z`` [m], up, 0 at the surface."""

    stamp_ns: int
    z: float


@dataclass(frozen=True, slots=True)
class BodyVelocity:
    """A DVL's linear velocity (3,) of ``base_link`` [m/s] and its covariance (3, 3)."""

    stamp_ns: int
    velocity: Array
    covariance: Array


Measurement = Beam | Inertial | Depth | BodyVelocity


@dataclass(frozen=True, slots=True)
class Odometry:
    """Dead reckoning at one stamp, in ``odom``.

    ``pose`` (6,) is x, y, z, roll, pitch, yaw; ``covariance`` (6, 6) its covariance; ``twist``
    (6,) linear and angular velocity of the body; ``twist_covariance`` (6, 6) the covariance of
    that velocity's slowly changing error.
    """

    stamp_ns: int
    pose: Array
    covariance: Array
    twist: Array
    twist_covariance: Array

    @property
    def planar(self) -> Array:
        """The planar pose (x, y, yaw)."""
        return self.pose[[0, 1, 5]]


@dataclass(frozen=True, slots=True)
class Reading:
    """The candidate echoes of one beam, nearest first; an element of the reading history RH.

    ``ranges`` (k,) leading edges [m], ``variances`` (k,) [m^2], ``levels`` (k,) echo levels [dB].
    k may be 0. ``maximum_range`` is the last bin [m]; ``saturated`` and ``empty`` flag the beam.
    """

    stamp_ns: int
    bearing: float
    ranges: Array
    variances: Array
    levels: Array
    maximum_range: float
    saturated: bool = False
    empty: bool = False

    def having(self, chosen: NDArray[np.bool_]) -> "Reading":
        """Return the reading with chosen ones (k,) of its echoes."""
        return Reading(
            self.stamp_ns,
            self.bearing,
            self.ranges[chosen],
            self.variances[chosen],
            self.levels[chosen],
            self.maximum_range,
            self.saturated,
            self.empty,
        )


@dataclass(frozen=True, slots=True)
class Scan:
    """One motion-compensated turn in the frame {I} of the vehicle at its first beam.

    What was measured: ``beam_stamps_ns`` (b,); ``reckoned`` (b + 1, 6) the dead-reckoned poses in
    ``odom`` at every beam and at ``end_stamp_ns``, where the next scan starts, and the covariance
    ``twist_covariance`` (3, 3) of the slow error in it: surge, sway [m/s] and yaw rate [rad/s].
    ``beam_index`` (n,) is the beam each point was measured in, ``body_points`` (n, 2) [m] and
    ``body_covariances`` (n, 2, 2) [m^2] stand in the levelled ``base_link`` of that beam.
    How it is laid out: ``motion`` (b, 3) the vehicle's pose at each beam in {I} with its
    ``motion_covariances`` (b, 3, 3); ``points`` (n, 2) and ``covariances`` (n, 2, 2) in {I}, the
    motion's uncertainty included.
    ``complete`` says whether the head finished the turn. A turn that was dropped is not
    ``usable``: its beams get poses, but it makes no keyframe.
    """

    beam_stamps_ns: Stamps
    end_stamp_ns: int
    reckoned: Array
    twist_covariance: Array
    beam_index: NDArray[np.intp]
    body_points: Array
    body_covariances: Array
    motion: Array
    motion_covariances: Array
    points: Array
    covariances: Array
    complete: bool = True
    usable: bool = True

    @property
    def stamp_ns(self) -> int:
        """Stamp of the first beam, by which the scan is known."""
        return int(self.beam_stamps_ns[0])

    @property
    def beam_times(self) -> Array:
        """Seconds since the first beam of every beam and of ``end_stamp_ns`` (b + 1,)."""
        stamps = np.append(self.beam_stamps_ns, self.end_stamp_ns)
        return np.asarray((stamps - self.stamp_ns) * 1e-9)

    @property
    def odometry(self) -> Array:
        """The dead reckoning (3,) of {I} in ``odom``."""
        return self.reckoned[0, [0, 1, 5]]

    @property
    def heights(self) -> Array:
        """The vehicle's z (b,) at each beam [m]."""
        return self.reckoned[:-1, 2]


class ConstraintKind(StrEnum):
    """Where a constraint comes from."""

    ODOMETRY = "odometry"
    CONSECUTIVE = "consecutive"
    LOOP = "loop"


@dataclass(frozen=True, slots=True)
class Constraint:
    """An edge tried between two keyframes: pose of ``second`` in ``first``, accepted or refused.

    ``relative_pose`` (3,), ``covariance`` (3, 3). ``refusal`` is empty where it was accepted.
    ``figures`` holds the gates' values by name.
    """

    kind: ConstraintKind
    first: int
    second: int
    relative_pose: Array
    covariance: Array
    refusal: str = ""
    figures: dict[str, float] = field(default_factory=dict)

    @property
    def accepted(self) -> bool:
        """Whether the constraint is part of the graph."""
        return not self.refusal


@dataclass(frozen=True, slots=True)
class Keyframe:
    """A node of the graph: the scan, and its pose (3,) and covariance (3, 3) in ``map``."""

    scan: Scan
    pose: Array
    covariance: Array


@dataclass(frozen=True, slots=True)
class SonarCalibration:
    """By what the sonar's motion differs from that of a velocity sensor.

    If the latter is right, the head points ``yaw`` [rad] further counter-clockwise than assumed,
    and ranges are ``scale`` times as long. ``covariance`` (2, 2) is that of yaw and scale.
    """

    yaw: float
    scale: float
    covariance: Array

    @property
    def deviations(self) -> tuple[float, float]:
        """The standard deviations of yaw [rad] and scale."""
        yaw, scale = np.sqrt(np.diag(self.covariance)).tolist()
        return yaw, scale


@dataclass(frozen=True, slots=True)
class TwistError:
    """The slow error of dead reckoning's twist that the sonar has shown.

    ``mean`` (3,) has to be added to surge, sway [m/s] and yaw rate [rad/s]; ``covariance`` (3, 3).
    """

    mean: Array
    covariance: Array


@dataclass(frozen=True, slots=True)
class MapCorrection:
    """Where the vehicle was in the middle of the newest scan, in ``map``.

    ``pose`` (3,) with its ``covariance`` (3, 3) at ``stamp_ns``, the moment a scan knows best.
    """

    stamp_ns: int
    pose: Array
    covariance: Array
    twist_error: TwistError


@dataclass(frozen=True, slots=True)
class KeyframeReport:
    """All that the front end says of a new keyframe: what the back end needs to take it in.

    ``stamp_ns`` is its scan's, ``pose`` (3,) its first estimate in ``map``, ``odometry`` (3,) the
    dead reckoning of it; ``constraints`` are those tried, all of which end at it.
    """

    number: int
    stamp_ns: int
    pose: Array
    odometry: Array
    twist_error: TwistError
    constraints: tuple[Constraint, ...]


@dataclass(frozen=True, slots=True)
class GraphPoses:
    """The back end's answer: all keyframes as they stand.

    ``stamps_ns`` (n,), ``poses`` (n, 3) in ``map``, ``odometry`` (n, 3) their dead reckoning;
    ``covariances`` (n, 3, 3) each one's when it was added, which later ones only make smaller.
    """

    stamps_ns: Stamps
    poses: Array
    odometry: Array
    covariances: Array


@dataclass(frozen=True, slots=True)
class Trajectory:
    """Stamped poses: ``stamps_ns`` (n,), ``poses`` (n, 6) as x, y, z, roll, pitch, yaw."""

    stamps_ns: Stamps
    poses: Array

    @property
    def planar(self) -> Array:
        """The planar poses (n, 3)."""
        return self.poses[:, [0, 1, 5]]


@dataclass(frozen=True, slots=True)
class Estimate:
    """All that an estimator leaves at the end of a recording.

    ``trajectory`` holds the corrected pose at every beam after all data, ``dead_reckoning`` the
    EKF's at the same stamps; ``online`` what a subscriber got at the time, from when there was
    something to publish.
    ``keyframes`` carry the scans in their final layout, ``first_scans`` the same scans as dead
    reckoning laid them out. ``constraints`` are all that were tried, in order.
    ``sonar_calibration`` is None where no measured velocity tells of it.
    """

    estimator: str
    trajectory: Trajectory
    online: Trajectory
    dead_reckoning: Trajectory
    keyframes: Sequence[Keyframe]
    first_scans: Sequence[Scan]
    constraints: tuple[Constraint, ...]
    sonar_calibration: SonarCalibration | None = None
