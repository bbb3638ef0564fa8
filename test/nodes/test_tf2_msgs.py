# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The messages of ``/tf`` that the tests build are the real ones: one process hears another."""

import subprocess
import sys
from collections.abc import Iterator

import pytest
from nodes.processes import domain

pytestmark = pytest.mark.slow

COMMON = """
import rclpy
from geometry_msgs.msg import TransformStamped
from tf2_msgs.msg import TFMessage

rclpy.init()
node = rclpy.create_node("someone")
"""
SPEAKER = """
publisher = node.create_publisher(TFMessage, "/tf", 10)
while not publisher.get_subscription_count():
    rclpy.spin_once(node, timeout_sec=0.1)
message = TransformStamped(child_frame_id="odom")
message.header.frame_id = "map"
message.transform.translation.x = 1.5
publisher.publish(TFMessage(transforms=[message]))
publisher.wait_for_all_acked()
"""
LISTENER = """
heard = []
subscription = node.create_subscription(TFMessage, "/tf", heard.append, 10)
while not heard:
    rclpy.spin_once(node, timeout_sec=0.1)
(transform,) = heard[0].transforms
print(transform.header.frame_id, transform.child_frame_id, transform.transform.translation.x)
"""


@pytest.fixture
def environment(tf2_environment: dict[str, str]) -> Iterator[dict[str, str]]:
    with domain() as own:
        yield {**own.environment, **tf2_environment}


def test_one_process_hears_what_another_publishes(environment: dict[str, str]) -> None:
    speaker, listener = (
        subprocess.Popen(
            [sys.executable, "-c", COMMON + code],
            env=environment,
            stdout=subprocess.PIPE,
            text=True,
        )
        for code in (SPEAKER, LISTENER)
    )
    try:
        assert listener.communicate(timeout=60)[0].split() == ["map", "odom", "1.5"]
        assert speaker.wait(timeout=60) == 0
    finally:
        speaker.kill()
        listener.kill()
