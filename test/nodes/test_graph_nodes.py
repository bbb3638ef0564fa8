# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Front end and back end as real processes: the links, the files, what comes of a kill."""

import time
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from nodes.linked_nodes import scans_of
from nodes.processes import Domain, TestNode, wait_until
from promised_files import RUN_FILES
from rclpy.duration import Duration
from small_mission import estimated, recorded

from msss_graphslam.core.types import GraphPoses, Scan
from msss_graphslam.messages import encoding, link_decoding, topics
from msss_graphslam.results.directory import ResultDirectory
from msss_graphslam.ros.messages import make, message_class
from msss_graphslam.ros.qos import LATCHED_DEEP, STREAM, profile_of

pytestmark = pytest.mark.slow

TRIGGER = message_class("std_srvs/srv/Trigger")
GET_MAP = message_class("nav_msgs/srv/GetMap")


@cache
def scans() -> tuple[Scan, ...]:
    return tuple(scans_of(recorded().measurements))


class Surroundings(TestNode):
    """Passes for the nodes before and around the graph."""

    def __init__(self, of: Domain) -> None:
        super().__init__(of)
        self.heard: dict[str, list[Any]] = {}
        self._scans = self.node.create_publisher(
            message_class(topics.SCAN_BEAMS.type_name), topics.SCAN_BEAMS.name, LATCHED_DEEP
        )
        self._poses = self.node.create_publisher(
            message_class(topics.POSE.type_name), topics.POSE.name, STREAM
        )
        for topic in (
            topics.GRAPH_POSES,
            topics.CORRECTION,
            topics.SCANS_TAKEN,
            topics.CONSTRAINTS,
            topics.KEYFRAMES,
            topics.MARKERS,
            topics.PATH,
            topics.MAP,
            topics.MAP_POINTS,
        ):
            self._listen(topic)

    def publish(self, scan: Scan) -> None:
        self._scans.publish(encoding.scan_beams(make, scan))

    def publish_pose(self, stamp_ns: int) -> None:
        message = encoding.pose(make, stamp_ns, np.full(6, 0.5), np.eye(6))
        self._poses.publish(message)

    def have_arrived(self) -> bool:
        return bool(self._poses.wait_for_all_acked(Duration(seconds=20)))

    def newest(self) -> GraphPoses | None:
        heard = self.heard[topics.GRAPH_POSES.name]
        return link_decoding.graph_poses(heard[-1]) if heard else None

    def wait_for_keyframes(self, count: int) -> None:
        wait_until(
            lambda: (known := self.newest()) is not None and len(known.poses) >= count,
            f"{count} keyframes",
        )

    def save(self, node: str) -> str:
        while True:
            answer = self.call(TRIGGER, f"{node}/save")
            if answer.success:
                return str(answer.message)
            time.sleep(0.05)

    def _listen(self, topic: topics.Topic) -> None:
        heard = self.heard[topic.name] = []
        self.node.create_subscription(
            message_class(topic.type_name), topic.name, heard.append, profile_of(topic, 2000)
        )


def usable(count: int | None = None) -> int:
    return sum(scan.usable for scan in scans()[:count])


def test_both_nodes_write_what_the_offline_run_finds(at: Domain, tmp_path: Path) -> None:
    output = tmp_path / "out"
    with (
        Surroundings(at) as around,
        at.start("front_end") as front,
        at.start("back_end", output=output) as back,
    ):
        for scan in scans():
            around.publish(scan)
        around.wait_for_keyframes(usable())
        assert around.save("front_end") == f"{usable()} keyframes"
        for scan in scans():
            around.publish_pose(scan.stamp_ns)
        assert around.have_arrived()
        assert around.save("back_end") == f"wrote {output}"
        wait_until(lambda: len(around.heard[topics.MAP.name]), "a map")
        grid = around.call(GET_MAP, "get_map").map
        assert grid.info.width * grid.info.height == len(grid.data) > 100
        assert front.interrupt() == back.interrupt() == 0
    assert all(around.heard.values()), {name: len(all_) for name, all_ in around.heard.items()}
    assert {path.name for path in output.iterdir()} == RUN_FILES
    directory = ResultDirectory(output)
    expected = estimated("full")
    corrected, online, reckoned = directory.read_trajectories()
    np.testing.assert_allclose(corrected.planar, expected.trajectory.planar, rtol=0, atol=2e-6)
    np.testing.assert_allclose(reckoned.planar, expected.dead_reckoning.planar, atol=2e-6)
    assert online.stamps_ns.tolist() == [scan.stamp_ns for scan in scans()]
    np.testing.assert_allclose(online.planar, 0.5, atol=1e-6)
    summary = directory.read_summary()
    assert summary["scans"] == usable()
    assert summary["refused"] == {}
    assert summary["configuration"]["estimator"] == "full"


@pytest.mark.parametrize("killed", ["front_end", "back_end"])
def test_a_node_that_was_killed_comes_back_to_the_same_graph(at: Domain, killed: str) -> None:
    half = len(scans()) // 2
    with (
        Surroundings(at) as around,
        at.start("front_end") as front,
        at.start("back_end") as back,
    ):
        for scan in scans()[:half]:
            around.publish(scan)
        around.wait_for_keyframes(usable(half))
        {"front_end": front, "back_end": back}[killed].kill()
        with at.start(killed):
            for scan in scans()[half:]:
                around.publish(scan)
            around.wait_for_keyframes(usable())
            around.save("front_end")
        known = around.newest()
        taken = link_decoding.moment(around.heard[topics.SCANS_TAKEN.name][-1])
    assert known is not None
    assert taken == scans()[-1].end_stamp_ns + (not scans()[-1].complete)
    assert known.stamps_ns.tolist() == [f.scan.stamp_ns for f in estimated("full").keyframes]


@pytest.mark.parametrize("node", ["front_end", "back_end"])
def test_an_unknown_estimator_ends_the_node_with_one_line(at: Domain, node: str) -> None:
    with at.start(node, estimator="best") as process:
        assert process.wait() == 1
    assert "unknown estimator 'best'; choose one of dead_reckoning" in process.output
    assert "Traceback" not in process.output


def test_what_cannot_be_written_is_said_and_not_asked_again(at: Domain, tmp_path: Path) -> None:
    blocked = tmp_path / "file"
    blocked.write_text("in the way", encoding="utf-8")
    with Surroundings(at) as around, at.start("back_end", output=blocked):
        assert around.save("back_end") == "failed: no scan has come in"
        around.publish(scans()[0])
        wait_until(lambda: "cannot make this directory" in around.save("back_end"))


def test_results_are_written_though_nobody_published_a_pose(at: Domain, tmp_path: Path) -> None:
    output = tmp_path / "out"
    with (
        Surroundings(at) as around,
        at.start("front_end", estimator="uspic"),
        at.start("back_end", estimator="uspic", output=output, recording=tmp_path / "gone"),
    ):
        for scan in scans():
            around.publish(scan)
        around.wait_for_keyframes(usable())
        assert around.save("back_end") == f"wrote {output}"
    summary = ResultDirectory(output).read_summary()
    assert [entry for entry in summary["missing"] if entry.startswith("/pose: nothing came")]


def test_without_an_output_nothing_is_written(at: Domain) -> None:
    with Surroundings(at) as around, at.start("back_end"):
        assert around.save("back_end") == "nothing written: the parameter output is empty"
