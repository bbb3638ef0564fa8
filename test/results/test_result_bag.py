# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
from collections import defaultdict
from dataclasses import replace

import numpy as np
import pytest
from rosbags.highlevel import AnyReader
from scipy.spatial.transform import Rotation
from synthetic_run import BEAMS_A_TURN, synthetic_run, without_keyframes

from msss_graphslam.messages.topics import OUTPUTS
from msss_graphslam.recordings.typestore import TYPES
from msss_graphslam.results.result_bag import write_result_bag


@pytest.fixture(scope="module")
def record():
    return synthetic_run(4)


@pytest.fixture(scope="module")
def messages(record, tmp_path_factory):
    return read(record, tmp_path_factory.mktemp("bag") / "result.mcap")


def read(record, path):
    """Return (log time, message) by topic, as a foreign reader sees them."""
    write_result_bag(path, record)
    by_topic = defaultdict(list)
    with AnyReader([path], default_typestore=TYPES) as reader:
        for connection, stamp, raw in reader.messages():
            by_topic[connection.topic].append((stamp, reader.deserialize(raw, connection.msgtype)))
    return by_topic


def matrix(transform):
    placement = np.eye(4)
    rotation, shift = transform.rotation, transform.translation
    quaternion = [rotation.x, rotation.y, rotation.z, rotation.w]
    placement[:3, :3] = Rotation.from_quat(quaternion).as_matrix()
    placement[:3, 3] = shift.x, shift.y, shift.z
    return placement


def stamp_of(header):
    return header.stamp.sec * 1_000_000_000 + header.stamp.nanosec


def test_all_output_topics_are_there_with_their_types(messages):
    assert set(messages) == {topic.absolute for topic in OUTPUTS}
    for topic in OUTPUTS:
        assert messages[topic.absolute][0][1].__msgtype__ == topic.type_name


def test_the_frames_lead_from_map_to_the_corrected_pose(record, messages):
    poses = dict(
        zip(
            record.estimate.trajectory.stamps_ns.tolist(),
            record.estimate.trajectory.poses,
            strict=True,
        )
    )
    moving = [message for _, message in messages["/tf"] if len(message.transforms) == 2]
    assert len(moving) == len(poses)
    for message in moving[:: BEAMS_A_TURN // 2]:
        outer, inner = message.transforms
        assert (outer.header.frame_id, outer.child_frame_id) == ("map", "odom")
        assert (inner.header.frame_id, inner.child_frame_id) == ("odom", "base_link")
        x, y, z, roll, pitch, yaw = poses[stamp_of(outer.header)]
        expected = np.eye(4)
        expected[:3, :3] = Rotation.from_euler("ZYX", [yaw, pitch, roll]).as_matrix()
        expected[:3, 3] = x, y, z
        np.testing.assert_allclose(
            matrix(outer.transform) @ matrix(inner.transform), expected, atol=1e-9
        )


def test_a_keyframes_pose_has_the_keyframes_covariance(record, messages):
    by_stamp = {stamp_of(message.header): message for _, message in messages["/pose"]}
    for frame in record.estimate.keyframes:
        stated = by_stamp[frame.scan.stamp_ns].pose.covariance.reshape(6, 6)
        motion = frame.scan.motion_covariances[0]
        assert stated[5, 5] == pytest.approx(frame.covariance[2, 2] + motion[2, 2])
        assert np.trace(stated[:2, :2]) == pytest.approx(
            np.trace(frame.covariance[:2, :2]) + np.trace(motion[:2, :2])
        )


def test_scans_lie_in_their_keyframes_frame_and_come_when_whole(record, messages):
    frames = {
        message.transforms[0].child_frame_id: matrix(message.transforms[0].transform)
        for _, message in messages["/tf"]
        if len(message.transforms) == 1
    }
    assert len(messages["/scan"]) == len(record.estimate.keyframes)
    for (logged, cloud), frame in zip(messages["/scan"], record.estimate.keyframes, strict=True):
        assert logged == frame.scan.end_stamp_ns
        assert stamp_of(cloud.header) == frame.scan.stamp_ns
        np.testing.assert_allclose(frames[cloud.header.frame_id][:2, 3], frame.pose[:2])


def test_only_accepted_edges_are_constraints(record, messages):
    accepted = [edge for edge in record.estimate.constraints if edge.accepted]
    assert len(messages["/graph/constraints"]) == len(accepted) < len(record.estimate.constraints)


def test_speed_is_that_of_the_path(record, messages):
    path = record.estimate.dead_reckoning.planar[:, :2]
    speeds = np.linalg.norm(np.diff(path, axis=0), axis=1) / 0.2
    stated = [
        np.hypot(message.twist.twist.linear.x, message.twist.twist.linear.y)
        for _, message in messages["/odom"]
    ]
    np.testing.assert_allclose(stated[1:], speeds, rtol=1e-9)


def test_messages_are_in_the_order_of_time(messages):
    for entries in messages.values():
        stamps = [stamp for stamp, _ in entries]
        assert stamps == sorted(stamps)


def test_fast_beams_are_thinned_to_five_a_second(record, tmp_path):
    def hurried(trajectory):
        start = trajectory.stamps_ns[0]
        return replace(trajectory, stamps_ns=start + (trajectory.stamps_ns - start) // 5)

    estimate = record.estimate
    fast = replace(
        record,
        estimate=replace(
            without_keyframes(record).estimate,
            trajectory=hurried(estimate.trajectory),
            online=hurried(estimate.online),
            dead_reckoning=hurried(estimate.dead_reckoning),
        ),
    )
    odometry = read(fast, tmp_path / "result.mcap")["/odom"]
    periods = np.diff([stamp for stamp, _ in odometry])
    assert periods[:-1].min() >= 200_000_000
    assert len(odometry) < len(estimate.trajectory.stamps_ns) / 4


def test_less_than_a_turn_still_makes_a_bag(record, tmp_path):
    found = read(without_keyframes(record), tmp_path / "result.mcap")
    assert "/odom" in found
    assert "/pose" not in found
