# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Who hears what a node publishes, by the graph and by what the node says of itself."""

import pytest
from nodes.processes import Domain, TestNode, wait_until
from nodes.replay_listener import Listener

from msss_graphslam.messages import topics
from msss_graphslam.nodes.replay.links import Links
from msss_graphslam.ros.messages import message_class
from msss_graphslam.ros.qos import STREAM

pytestmark = pytest.mark.slow


def listen(node: TestNode) -> None:
    kind = message_class(topics.POSE.type_name)
    node.node.create_subscription(kind, "pose", lambda _: None, STREAM)


def test_a_publisher_started_again_has_to_find_its_listeners_anew(at: Domain) -> None:
    def is_reached() -> bool:
        return links.reach("pose", "back_end")

    with (
        TestNode(at) as replay,
        Listener(at) as reckoning,
        TestNode(at, "back_end") as back_end,
        TestNode(at, "viewer") as viewer,
    ):
        links = Links(replay.node)
        listen(back_end)
        wait_until(lambda: replay.node.count_subscribers("pose") == 1, "the subscription")
        assert not is_reached()
        wait_until(lambda: reckoning.tells(topics.POSE, 1) and is_reached(), "it is reached")
        listen(viewer)
        wait_until(lambda: replay.node.count_subscribers("pose") == 2, "the viewer's too")
        assert is_reached()
        wait_until(lambda: reckoning.tells(topics.POSE, 0) and not is_reached(), "not any more")
        wait_until(lambda: reckoning.tells(topics.POSE, 2) and is_reached(), "it is found again")
