# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""A made-up run for tests of results and report: two laps in a rectangular pond.

The truth is a smooth lap; dead reckoning turns away from it steadily, the estimate stays within
centimetres. Nothing here is an estimator: truth, drift and echoes are written down, not computed
from one another.
"""

from collections import Counter
from dataclasses import replace

import numpy as np

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.compounding import between, compose, transform_points
from msss_graphslam.core.maps.mapping import OccupancyGrid
from msss_graphslam.core.types import (
    Array,
    Constraint,
    ConstraintKind,
    Estimate,
    Keyframe,
    Scan,
    Trajectory,
)
from msss_graphslam.results.record import BagInfo, Cost, RunRecord

__all__ = ["synthetic_run"]

START_NS = 1_700_000_000_123_456_789
BEAMS_A_TURN = 60
BEAM_PERIOD_NS = 200_000_000
POND = np.array([33.0, 13.0])
LAUNCH = np.array([2.0, -1.0, 0.0])


def synthetic_run(
    turns: int = 12, *, estimator: str = "full", with_truth: bool = True
) -> RunRecord:
    """Return a whole record; the same arguments give the same record."""
    generator = np.random.default_rng(7)
    stamps = START_NS + BEAM_PERIOD_NS * np.arange(turns * BEAMS_A_TURN)
    truth = _lap(len(stamps))
    drifted = _drift(truth, 0.0012)
    estimate = _drift(truth, 0.00002) + generator.normal(0.0, 0.01, truth.shape) * [1, 1, 0.1]
    estimate[0] = drifted[0] = truth[0]
    if estimator == "dead_reckoning":
        estimate = drifted
    scans = [
        _scan(generator, stamps, truth, start) for start in range(0, len(stamps), BEAMS_A_TURN)
    ]
    first_scans = [_lay_out(scan, drifted, index) for index, scan in enumerate(scans)]
    keyframes = tuple(
        Keyframe(
            _lay_out(scan, estimate, index),
            estimate[index * BEAMS_A_TURN],
            np.diag([0.02, 0.02, 0.004]) ** 2 * (index + 0.1),
        )
        for index, scan in enumerate(scans)
    )
    return RunRecord(
        estimate=Estimate(
            estimator=estimator,
            trajectory=_trajectory(stamps, estimate),
            online=_trajectory(stamps, _drift(truth, 0.0003)),
            dead_reckoning=_trajectory(stamps, drifted),
            keyframes=keyframes,
            first_scans=tuple(first_scans),
            constraints=_constraints(generator, keyframes),
        ),
        points=np.vstack([transform_points(frame.pose, frame.scan.points) for frame in keyframes]),
        grid=_grid(),
        truth=_trajectory(stamps, truth + LAUNCH) if with_truth else None,
        beams=len(stamps),
        refused=Counter(beam_without_bins=3, imu_not_finite=1),
        configuration=Configuration().as_dict(),
        bag=BagInfo(
            name="pond.mcap",
            start_ns=int(stamps[0]),
            end_ns=int(stamps[-1]),
            messages={"/sonar/ping": len(stamps), "/imu/data": 10 * len(stamps)},
            missing=("No /dvl/twist: the forward speed is assumed.",),
        ),
        cost=Cost(
            wall=2.5,
            cpu=2.25,
            peak_rss_mib=180.0,
            stages={
                "beam_segmentation": generator.gamma(4.0, 2e-5, len(stamps)),
                "scan_matching": generator.gamma(4.0, 3e-4, 4 * turns),
                "back_end": generator.gamma(4.0, 5e-4, turns),
            },
        ),
        version="0.1.0",
        command="msss run pond.mcap --out out",
    )


def without_keyframes(record: RunRecord) -> RunRecord:
    """Return the record as a recording of less than a turn leaves it."""
    estimate = replace(record.estimate, keyframes=(), first_scans=(), constraints=())
    return replace(record, estimate=estimate, points=np.zeros((0, 2)))


def _lap(count: int) -> Array:
    phase = np.linspace(0.0, 4.0 * np.pi, count)
    x, y = 10.0 * np.sin(phase), 3.5 * (1.0 - np.cos(phase))
    return np.column_stack([x, y, np.unwrap(np.arctan2(np.gradient(y), np.gradient(x)))])


def _drift(poses: Array, rate: float) -> Array:
    """Turn every step a little more than the last."""
    steps = between(poses[:-1], poses[1:])
    steps[:, 2] += rate
    steps[:, 0] *= 1.0 + 40.0 * rate
    drifted = [poses[0]]
    for step in steps:
        drifted.append(compose(drifted[-1], step))
    return np.array(drifted)


def _trajectory(stamps: np.ndarray, planar: Array) -> Trajectory:
    poses = np.zeros((len(planar), 6))
    poses[:, [0, 1, 5]] = planar
    poses[:, 2] = -1.5
    return Trajectory(stamps, poses)


def _scan(generator: np.random.Generator, stamps: np.ndarray, truth: Array, start: int) -> Scan:
    """Measure the pond's walls from the true poses of one turn."""
    index = np.arange(start, start + BEAMS_A_TURN)
    bearing = 2.0 * np.pi * np.arange(BEAMS_A_TURN) / BEAMS_A_TURN
    heading = truth[index, 2] + bearing
    direction = np.column_stack([np.cos(heading), np.sin(heading)])
    walls = np.sign(direction) * POND / 2.0 + [0.0, 3.5]
    ranges = np.min((walls - truth[index, :2]) / direction, axis=1)
    ranges += generator.normal(0.0, 0.04, BEAMS_A_TURN)
    body = ranges[:, None] * np.column_stack([np.cos(bearing), np.sin(bearing)])
    end = int(stamps[index[-1]]) + BEAM_PERIOD_NS
    blank = np.tile(np.diag([0.04, 0.04]) ** 2, (BEAMS_A_TURN, 1, 1))
    return Scan(
        end_stamp_ns=end,
        beam_stamps_ns=stamps[index],
        motion=np.zeros((BEAMS_A_TURN, 3)),
        motion_covariances=np.tile(np.diag([1e-4, 1e-4, 1e-5]), (BEAMS_A_TURN, 1, 1)),
        reckoned=_reckoned(np.zeros((BEAMS_A_TURN, 3))),
        beam_index=np.arange(BEAMS_A_TURN),
        body_points=body,
        body_covariances=blank,
        points=body,
        covariances=blank,
        twist_covariance=np.diag([1e-4, 1e-4, 1e-6]),
    )


def _reckoned(planar: Array) -> Array:
    """The poses (b + 1, 6) of dead reckoning at the beams and at the turn's end."""
    poses = np.full((len(planar) + 1, 6), 0.0)
    poses[:, 2] = -1.5
    poses[:, [0, 1, 5]] = np.vstack([planar, planar[-1]])
    return poses


def _lay_out(scan: Scan, poses: Array, index: int) -> Scan:
    beams = poses[index * BEAMS_A_TURN : (index + 1) * BEAMS_A_TURN]
    motion = between(beams[0], beams)
    return replace(
        scan,
        motion=motion,
        points=transform_points(motion, scan.body_points),
        reckoned=_reckoned(beams),
    )


def _constraints(
    generator: np.random.Generator, keyframes: tuple[Keyframe, ...]
) -> tuple[Constraint, ...]:
    edges = []
    for second in range(1, len(keyframes)):
        edges.append(_edge(keyframes, ConstraintKind.ODOMETRY, second - 1, second))
        edges.append(_edge(keyframes, ConstraintKind.CONSECUTIVE, second - 1, second))
        for first in range(second - 1):
            distance = float(
                np.linalg.norm(keyframes[first].pose[:2] - keyframes[second].pose[:2])
            )
            shape = float(generator.uniform(0.0, 0.7))
            edges.append(
                replace(
                    _edge(keyframes, ConstraintKind.LOOP, first, second),
                    refusal=_refusal(distance, shape),
                    figures={"mahalanobis": distance**2}
                    | ({"shape_distance": shape} if distance < 9.0 else {}),
                )
            )
    return tuple(edges)


def _edge(
    keyframes: tuple[Keyframe, ...], kind: ConstraintKind, first: int, second: int
) -> Constraint:
    return Constraint(
        kind,
        first,
        second,
        between(keyframes[first].pose, keyframes[second].pose),
        np.array([[4e-4, 1e-5, 0.0], [1e-5, 4e-4, 2e-6], [0.0, 2e-6, 1e-5]]),
    )


def _refusal(distance: float, shape: float) -> str:
    if distance > 9.0:
        return "mahalanobis_distance"
    return "shape_distance" if shape > 0.45 else ""


def _grid() -> OccupancyGrid:
    """Free water inside the pond, walls around it, unknown beyond."""
    resolution = 0.25
    rows, columns = (np.ceil((POND[::-1] + 4.0) / resolution)).astype(int)
    south_west = np.array([-POND[0] / 2.0 - 2.0, 3.5 - POND[1] / 2.0 - 2.0])
    y, x = np.meshgrid(np.arange(rows), np.arange(columns), indexing="ij")
    offset = np.abs(
        south_west + (np.stack([x, y], axis=-1) + 0.5) * resolution - np.array([0.0, 3.5])
    )
    outside = (offset - POND / 2.0).max(axis=-1)
    occupancy = np.where(outside < -0.25, 5, np.where(outside < 0.25, 90, -1))
    return OccupancyGrid(occupancy.astype(np.int8), resolution, south_west)
