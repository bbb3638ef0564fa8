# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The transforms of ``/tf``: really published where its messages are installed."""

import sys
from importlib.util import find_spec
from pathlib import Path

import pytest
from nodes.processes import Domain, NodeProcess
from system.fleet import Fleet, Surroundings
from system.missions import Mission

pytestmark = pytest.mark.slow

_LISTENER = """
import sys

import rclpy
from tf2_msgs.msg import TFMessage

rclpy.init()
node = rclpy.create_node("listener")
heard = set()


def take(message):
    heard.update((each.header.frame_id, each.child_frame_id) for each in message.transforms)


subscription = node.create_subscription(TFMessage, "/tf", take, 100)
print("listening", flush=True)
while not {("map", "odom"), ("odom", "base_link")} <= heard:
    rclpy.spin_once(node, timeout_sec=0.1)
print("heard both", flush=True)
"""


def test_both_transforms_are_heard(
    pond: Mission, own_domain: Domain, tf2_environment: dict[str, str], tmp_path: Path
) -> None:
    domain = Surroundings(own_domain.number, tf2_environment)
    command = [sys.executable, "-c", _LISTENER]
    with Fleet(domain, tmp_path / "live") as fleet, NodeProcess(command, domain) as listener:
        listener.wait_for_output("listening")
        fleet.start()
        fleet.replay(pond.bag, 20)
        listener.wait_for_output("heard both")
        assert listener.wait() == 0


@pytest.mark.skipif(find_spec("tf2_msgs") is not None, reason="tf2_msgs is installed here")
def test_without_their_messages_one_line_says_so(own_domain: Domain, tmp_path: Path) -> None:
    with Fleet(own_domain, tmp_path / "live") as fleet:
        fleet.start("dead_reckoning")
        node = fleet.nodes["dead_reckoning"]
        node.wait_for_output("tf2_msgs is not installed")
        assert node.interrupt() == 0
        assert node.output.count("tf2_msgs") == 1
