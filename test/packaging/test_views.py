# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The views for RViz and Foxglove show topics that exist, in the way they are published."""

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import yaml

from msss_graphslam.messages.topics import INPUTS, LINKS, OUTPUTS
from msss_graphslam.ros.input_watch import InputWatch

CONFIG = Path(__file__).parents[2] / "config"
RVIZ = yaml.safe_load((CONFIG / "msss_graphslam.rviz").read_text(encoding="utf-8"))
FOXGLOVE = json.loads((CONFIG / "foxglove_layout.json").read_text(encoding="utf-8"))
TOPICS = {topic.absolute: topic for topic in INPUTS + OUTPUTS + LINKS}
KNOWN = {*TOPICS, "/diagnostics", "/tf", "/map_updates"}
"""RViz wants a topic for updates of the map; nothing is published there."""
GLANCE = {"/path", "/path/dead_reckoning", "/scan", "/graph/markers", "/map", "/map/points"}
SHOWS = {
    "Map": "nav_msgs/msg/OccupancyGrid",
    "MarkerArray": "visualization_msgs/msg/MarkerArray",
    "Path": "nav_msgs/msg/Path",
    "PointCloud2": "sensor_msgs/msg/PointCloud2",
    "PoseWithCovariance": "geometry_msgs/msg/PoseWithCovarianceStamped",
}
DISPLAYS = {
    display["Topic"]["Value"]: display
    for display in RVIZ["Visualization Manager"]["Displays"]
    if "Topic" in display
}


def texts(value: Any) -> Iterator[str]:
    """Yield every string of a document, keys as well."""
    if isinstance(value, dict):
        for key, entry in value.items():
            yield key
            yield from texts(entry)
    elif isinstance(value, list):
        for entry in value:
            yield from texts(entry)
    elif isinstance(value, str):
        yield value


def panels(layout: Any) -> Iterator[str]:
    """Yield the panels that an arrangement places."""
    if isinstance(layout, str):
        yield layout
    elif layout is not None:
        yield from panels(layout["first"])
        yield from panels(layout["second"])


@pytest.mark.parametrize("document", [RVIZ, FOXGLOVE], ids=["rviz", "foxglove"])
def test_every_topic_exists(document: Any) -> None:
    named = {re.split(r"\.", text)[0] for text in texts(document) if text.startswith("/")}
    assert named - KNOWN == set()
    assert named >= GLANCE | {"/pose"}


def test_rviz_shows_everything_in_the_map_frame() -> None:
    assert RVIZ["Visualization Manager"]["Global Options"]["Fixed Frame"] == "map"
    displays = RVIZ["Visualization Manager"]["Displays"]
    assert "rviz_default_plugins/TF" in [display["Class"] for display in displays]
    assert all(display["Enabled"] for display in displays)


@pytest.mark.parametrize("name", sorted(DISPLAYS))
def test_rviz_takes_each_topic_as_it_is_published(name: str) -> None:
    kind = DISPLAYS[name]["Class"].removeprefix("rviz_default_plugins/")
    assert SHOWS[kind] == TOPICS[name].type_name
    durability = "Transient Local" if TOPICS[name].latched else "Volatile"
    assert DISPLAYS[name]["Topic"]["Durability Policy"] == durability


def test_foxglove_has_a_panel_for_each_purpose() -> None:
    configured = FOXGLOVE["configById"]
    kinds = {name.partition("!")[0] for name in configured}
    assert kinds >= {"3D", "Plot", "DiagnosticSummary", "RawMessages"}
    assert set(configured["3D!scene"]["topics"]) <= set(TOPICS)
    assert configured["3D!scene"]["followTf"] == "map"


def test_foxglove_places_every_panel_that_it_configures() -> None:
    configured = FOXGLOVE["configById"]
    placed = set(panels(FOXGLOVE["layout"]))
    for name in [name for name in placed if name.startswith("Tab!")]:
        placed |= {panel for tab in configured[name]["tabs"] for panel in panels(tab["layout"])}
    assert placed == set(configured)


def test_foxglove_plots_figures_that_the_diagnostics_have() -> None:
    pattern = r'/diagnostics\.status\[:\]\{name=="/(\w+)"\}\.values\[:\]\{key=="([^"]+)"\}\.value'
    found = [
        re.fullmatch(pattern, text) for text in texts(FOXGLOVE) if text.startswith("/diagnostics.")
    ]
    assert found
    for match in found:
        assert match is not None
        name = match[2].partition("/")[2]
        assert f"/{name}" in TOPICS
        assert match[2] in dict(InputWatch(name, lambda: 0.0).values)
