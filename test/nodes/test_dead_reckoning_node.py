# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The dead reckoning node as a process: what it says is what the core says."""

from collections import Counter
from collections.abc import Iterator
from dataclasses import fields
from typing import Any

import numpy as np
import pytest

pytest.importorskip("rclpy", reason="needs rclpy")

from nodes.fed_nodes import START_NS, Fed, dive, fed, measurement_of
from nodes.processes import wait_until

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.reckoning.prompt_dead_reckoning import PromptDeadReckoning
from msss_graphslam.core.types import MapCorrection, Odometry, Trajectory, TwistError
from msss_graphslam.messages import decoding, encoding, link_decoding, topics
from msss_graphslam.messages.topics import Topic
from msss_graphslam.ros.messages import make

INPUTS = (topics.IMU, topics.PRESSURE, topics.DVL, topics.SONAR_PING)
Sent = list[tuple[Topic, Any]]


@pytest.fixture
def node() -> Iterator[Fed]:
    with fed("dead_reckoning") as feeder:
        for topic in (topics.ODOM, topics.POSE, topics.SETTLED_ODOMETRY):
            feeder.hear(topic)
        for topic in INPUTS:
            feeder.offer(topic)
        yield feeder


def send_all(node: Fed, sent: Sent) -> None:
    """Send as a replay does: not further ahead than the node can put into order."""
    for first in range(0, len(sent), 20):
        part = sent[first : first + 20]
        for topic, message in part:
            node.send(topic, message)
        wait_until(lambda part=part: all_taken(node, part), "input taken")


def all_taken(node: Fed, sent: Sent) -> bool:
    """Whether dead reckoning says that it has taken the newest sample of the IMU."""
    settled = node.heard(topics.SETTLED_ODOMETRY)
    newest = max(measurement_of(*one).stamp_ns for one in sent if one[0] is topics.IMU)
    return bool(settled) and link_decoding.settled_odometry(settled[-1]).stamp_ns >= newest


def saved(node: Fed) -> Any:
    """The answer to a save once it succeeds."""
    answers: list[Any] = []

    def ask() -> bool:
        answers.append(node.trigger("save"))
        return bool(answers[-1].success)

    wait_until(ask, "saved")
    assert {one.message for one in answers[:-1]} <= {"input still comes in"}
    return answers[-1]


def settled_rows(node: Fed) -> list[Odometry]:
    heard = node.heard(topics.SETTLED_ODOMETRY)
    return [row for one in heard for row in link_decoding.settled_odometry(one).entries]


def reckoned(sent: Sent) -> list[Odometry]:
    """What the core says, however the measurements arrive."""
    core = PromptDeadReckoning(Configuration(), Counter())
    answers = [core.process(measurement_of(*one)).settled for one in sent]
    return [row for rows in [*answers, core.finish()] for row in rows]


def test_settled_odometry_is_the_core_s_to_the_bit(node: Fed) -> None:
    sent = dive()
    send_all(node, sent)
    answer = saved(node)
    assert answer.message.endswith("held measurements worked off")
    expected = reckoned(sent)
    wait_until(lambda: len(settled_rows(node)) >= len(expected), "all settled")
    for found, wanted in zip(settled_rows(node), expected, strict=True):
        for field in fields(Odometry):
            np.testing.assert_array_equal(getattr(found, field.name), getattr(wanted, field.name))


def test_odometry_and_pose_agree_until_a_correction_comes(node: Fed) -> None:
    node.offer(topics.CORRECTION)
    sent = dive()
    send_all(node, sent)
    wait_until(lambda: node.heard(topics.POSE), "a pose")
    odometry = decoding.true_pose(node.heard(topics.ODOM)[-1])
    np.testing.assert_allclose(
        link_decoding.stamped_pose(node.heard(topics.POSE)[-1]).pose, odometry.pose, atol=1e-9
    )
    shifted = odometry.pose[[0, 1, 5]] + np.array([3.0, -4.0, 0.0])
    error = TwistError(np.zeros(3), np.eye(3) * 1e-6)
    correction = MapCorrection(odometry.stamp_ns, shifted, np.eye(3) * 0.01, error)
    node.send(topics.CORRECTION, encoding.correction(make, correction))
    wait_until(lambda: node.diagnostic("corrections") == "1", "the correction taken")
    assert float(node.diagnostic("last_jump")) == pytest.approx(5.0, abs=1e-3)
    later = dive(0.5, START_NS + 8 * 10**9)
    send_all(node, later)
    found = link_decoding.stamped_pose(node.heard(topics.POSE)[-1])
    reckoned_then = decoding.true_pose(node.heard(topics.ODOM)[-1])
    np.testing.assert_allclose(
        (found.pose - reckoned_then.pose)[[0, 1, 5]], [3.0, -4.0, 0.0], atol=0.05
    )


def test_a_restarted_node_goes_on_from_the_latched_path() -> None:
    before = np.array([50.0, -20.0, -2.0, 0.0, 0.0, 0.5])
    stamps = START_NS - np.array([2, 1]) * 10**9
    path = encoding.path(make, Trajectory(stamps, np.stack([before - 0.1, before])), "odom")
    with fed("dead_reckoning") as node:
        for topic in (topics.RECKONED_PATH, *INPUTS):
            node.offer(topic)
        node.hear(topics.ODOM)
        node.hear(topics.SETTLED_ODOMETRY)
        node.send(topics.RECKONED_PATH, path)
        taken = f"received/{topics.RECKONED_PATH.name}"
        wait_until(lambda: node.diagnostic(taken) == "1", "the path taken", 20.0)
        send_all(node, dive(0.3))
        wait_until(lambda: node.diagnostic("resumed") == "1", "resumed")
        first = decoding.true_pose(node.heard(topics.ODOM)[0])
        assert np.hypot(*(first.pose[:2] - before[:2])) < 2.0


def test_after_a_reset_a_dive_begins_anew(node: Fed) -> None:
    send_all(node, dive(0.5, START_NS + 100 * 10**9))
    assert node.trigger("reset").success
    send_all(node, dive(0.5))
    wait_until(lambda: newest_odometry(node).stamp_ns < START_NS + 100 * 10**9, "earlier odometry")


def newest_odometry(node: Fed) -> Any:
    return decoding.true_pose(node.heard(topics.ODOM)[-1])


def test_beams_are_kept_for_who_comes_late_but_not_beyond_a_reset(node: Fed) -> None:
    beams = [message for topic, message in dive() if topic is topics.SONAR_PING]
    for message in beams[:30]:
        node.send(topics.SONAR_PING, message)
    wait_until(lambda: node.diagnostic("received/sonar/ping") == "30", "the beams taken")
    node.hear(topics.RECENT_BEAMS)
    wait_until(lambda: len(node.heard(topics.RECENT_BEAMS)) == 30, "the beams again")
    for kept, sent in zip(node.heard(topics.RECENT_BEAMS), beams, strict=False):
        found, wanted = decoding.beam(kept), decoding.beam(sent)
        assert (found.stamp_ns, found.bearing) == (wanted.stamp_ns, wanted.bearing)
        np.testing.assert_array_equal(found.ranges, wanted.ranges)
        np.testing.assert_array_equal(found.intensities, wanted.intensities)
    assert node.trigger("reset").success
    node.send(topics.SONAR_PING, beams[30])
    wait_until(lambda: len(node.heard(topics.RECENT_BEAMS)) == 31, "one more")
    node.hear(topics.RECENT_BEAMS)  # a second listener gets what is kept: that one
    wait_until(lambda: len(node.heard(topics.RECENT_BEAMS)) >= 32, "the one kept")
    node.send(topics.SONAR_PING, beams[31])
    wait_until(lambda: len(node.heard(topics.RECENT_BEAMS)) >= 34, "the next, twice")
    assert len(node.heard(topics.RECENT_BEAMS)) == 34
