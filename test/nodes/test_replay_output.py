# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The names that a replay publishes under, in a vehicle's namespace."""

import pytest
from nodes.processes import TestNode, domain

from msss_graphslam.nodes.replay.output import Output
from msss_graphslam.recordings.recorded_topics import RecordedTopic


@pytest.mark.parametrize(
    ("recorded", "type_name", "published"),
    [
        ("/old/sonar/ping", "sensor_msgs/msg/LaserScan", "/auv/sonar/ping"),
        ("/sonar/ping", "sensor_msgs/msg/LaserScan", "/auv/sonar/ping"),
        ("/diagnostics", "diagnostic_msgs/msg/DiagnosticArray", "/diagnostics"),
        ("/camera/info", "std_msgs/msg/Header", "/auv/camera/info"),
    ],
)
def test_the_vehicles_topics_are_in_its_namespace_the_others_are_not(
    recorded: str, type_name: str, published: str
) -> None:
    with domain() as own, TestNode(own, namespace="/auv") as replay:
        output = Output(replay.node, [RecordedTopic(recorded, type_name, 1)])
        (publisher,) = output.by_name.values()
        assert publisher.topic_name == published
