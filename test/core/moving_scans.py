# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Scans of a slow head on a vehicle that moves, of whose motion dead reckoning knows nothing."""

from collections.abc import Sequence

import numpy as np
from synthetic_scans import RANGE_NOISE, _cast, _covariances, basin, corridor

from msss_graphslam.core.compounding import compose
from msss_graphslam.core.scans.scan_generation import reckoned_scan
from msss_graphslam.core.types import Array, Scan

BASIN = [np.add(wall, [0.0, 5.0]) for wall in basin(np.random.default_rng(5))]
"""The vehicle starts between the island and the southern wall."""
CORRIDOR = corridor()
BEAMS = 240
TURN_NS = 10_000_000_000
BLIND = np.diag([0.15, 0.15, 0.03]) ** 2
"""Covariance of the twist of a vehicle without any sensor of motion."""


def moving_scans(
    walls: Sequence[Array],
    count: int,
    *,
    twist: Array | None = None,
    noise: float = 1.0,
    doubt: Array = BLIND,
) -> tuple[list[Scan], Array]:
    """Return the scans and the keyframes' true poses (count + 1, 3), the last one's end too.

    The vehicle moves at the ``twist`` (3,), dead reckoning has it at rest. ``noise`` scales the
    sonar's.
    """
    rng = np.random.default_rng(8)
    twist = np.array([0.12, 0.03, 0.012]) if twist is None else twist
    poses = [np.zeros(3)]
    for _ in range(count * BEAMS):
        poses.append(compose(poses[-1], twist * 10.0 / BEAMS))
    truth = np.array(poses)
    scans = [_scan(walls, truth, number, noise, doubt, rng) for number in range(count)]
    return scans, truth[::BEAMS]


def _scan(
    walls: Sequence[Array],
    truth: Array,
    number: int,
    noise: float,
    doubt: Array,
    rng: np.random.Generator,
) -> Scan:
    poses = truth[number * BEAMS : (number + 1) * BEAMS]
    bearings = np.linspace(-np.pi, np.pi, BEAMS, endpoint=False)
    ranges = np.array(
        [
            _cast(list(walls), pose, np.array([look]))[0]
            for pose, look in zip(poses, bearings, strict=True)
        ]
    )
    ranges += noise * rng.normal(0.0, RANGE_NOISE, BEAMS)
    hits = np.flatnonzero(ranges < 30.0)
    places = np.column_stack([np.cos(bearings), np.sin(bearings)]) * ranges[:, None]
    start = number * TURN_NS
    return reckoned_scan(
        beam_stamps_ns=start + TURN_NS // BEAMS * np.arange(BEAMS, dtype=np.int64),
        end_stamp_ns=start + TURN_NS,
        reckoned=np.zeros((BEAMS + 1, 6)),
        twist_covariance=doubt,
        beam_index=hits,
        body_points=places[hits],
        body_covariances=_covariances(bearings, ranges)[hits],
    )
