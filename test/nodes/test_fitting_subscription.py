# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What a subscription asks for where it may not lose anything, and where that is not offered."""

import pytest
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

from msss_graphslam.messages import topics
from msss_graphslam.nodes.fitting_subscription import fitting
from msss_graphslam.ros.qos import DEEP, profile_of

RELIABLE, BEST_EFFORT = ReliabilityPolicy.RELIABLE, ReliabilityPolicy.BEST_EFFORT
LATCHED, VOLATILE = DurabilityPolicy.TRANSIENT_LOCAL, DurabilityPolicy.VOLATILE


def offer(reliability: ReliabilityPolicy, durability: DurabilityPolicy) -> QoSProfile:
    return QoSProfile(depth=1, reliability=reliability, durability=durability)


@pytest.mark.parametrize("topic", [topics.SONAR_PING, topics.KEYFRAMES])
@pytest.mark.parametrize("count", [0, 2])
def test_of_publishers_like_ours_nothing_is_lost(topic: topics.Topic, count: int) -> None:
    ours = profile_of(topic)
    profile = fitting(topic, [ours] * count)
    assert (profile.reliability, profile.durability) == (RELIABLE, ours.durability)
    assert profile.depth == DEEP


@pytest.mark.parametrize(
    ("offered", "reliability", "durability"),
    [
        ([offer(RELIABLE, LATCHED)], RELIABLE, LATCHED),
        ([offer(RELIABLE, VOLATILE)], RELIABLE, VOLATILE),
        ([offer(BEST_EFFORT, LATCHED)], BEST_EFFORT, LATCHED),
        ([offer(RELIABLE, LATCHED), offer(BEST_EFFORT, VOLATILE)], BEST_EFFORT, VOLATILE),
        ([offer(BEST_EFFORT, VOLATILE), offer(RELIABLE, LATCHED)], BEST_EFFORT, VOLATILE),
    ],
)
def test_one_that_offers_less_decides_for_all(
    offered: list[QoSProfile], reliability: ReliabilityPolicy, durability: DurabilityPolicy
) -> None:
    profile = fitting(topics.KEYFRAMES, offered)
    assert (profile.reliability, profile.durability) == (reliability, durability)


def test_what_is_latched_is_not_asked_of_a_stream() -> None:
    profile = fitting(topics.SONAR_PING, [offer(RELIABLE, LATCHED)])
    assert profile.durability == VOLATILE
