# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Many messages at once: the bytes of the same messages made one by one of objects."""

import numpy as np
import pytest

from msss_graphslam.core.types import Odometry, Trajectory
from msss_graphslam.messages import encoding
from msss_graphslam.messages.encoding import batches
from msss_graphslam.recordings.typestore import TYPES, make

STAMP = 1_700_000_000_999_999_999
COUNTS = [0, 1, 2, 9]


def track(count: int) -> Trajectory:
    poses = np.random.default_rng(count).uniform(-3.0, 3.0, (count, 6))
    poses[:, 3:] = 0.0
    return Trajectory(STAMP + np.arange(count) * 333_333_333, poses)


@pytest.mark.parametrize("count", COUNTS)
def test_odometry(count: int) -> None:
    way, unknown = track(count), np.zeros((6, 6))
    twists = np.random.default_rng(1).normal(size=(count, 6))
    expected = [
        encoding.odometry(make, Odometry(stamp, pose, unknown, twist, unknown))
        for stamp, pose, twist in zip(way.stamps_ns.tolist(), way.poses, twists, strict=True)
    ]
    found = batches.odometries(way, twists)
    assert found == [bytes(TYPES.serialize_cdr(each, each.__msgtype__)) for each in expected]


@pytest.mark.parametrize("count", COUNTS)
def test_planar_poses(count: int) -> None:
    way = track(count)
    covariances = np.random.default_rng(1).normal(size=(count, 3, 3))
    expected = [
        encoding.pose(make, stamp, pose, covariance)
        for stamp, pose, covariance in zip(
            way.stamps_ns.tolist(), way.poses, covariances, strict=True
        )
    ]
    found = batches.planar_poses(way, covariances)
    assert found == [bytes(TYPES.serialize_cdr(each, each.__msgtype__)) for each in expected]


@pytest.mark.parametrize("frames", [("map", "odom"), ("a", "bc"), ("öl", "keyframe_1"), ("", "")])
@pytest.mark.parametrize("count", COUNTS)
def test_transforms(count: int, frames: tuple[str, str]) -> None:
    way, other = track(count), track(count).poses[::-1]
    placements = [(way.poses, *frames), (other, *frames[::-1])]
    found = batches.transforms(way.stamps_ns, placements)
    assert len(found) == count
    for row, stamp in enumerate(way.stamps_ns.tolist()):
        each = [
            encoding.transform(make, stamp, poses[row], frame, child)
            for poses, frame, child in placements
        ]
        message = encoding.tf_message(make, each)
        assert found[row] == bytes(TYPES.serialize_cdr(message, message.__msgtype__))


def test_stamps_and_numbers_that_do_not_go_together_are_an_error() -> None:
    with pytest.raises(ValueError, match=r"dimension|broadcast"):
        batches.odometries(track(3), np.zeros((2, 6)))
    with pytest.raises(ValueError, match="broadcast"):
        batches.transforms(track(3).stamps_ns, [(np.zeros((2, 6)), "map", "odom")])
