# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The scan generation node as a process: its scans are the core's, to the bit."""

from collections import Counter
from collections.abc import Iterator
from dataclasses import fields

import numpy as np
import pytest

pytest.importorskip("rclpy", reason="needs rclpy")

from nodes.fed_nodes import Fed, dive, fed, measurement_of
from nodes.processes import wait_until

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.reckoning.prompt_dead_reckoning import PromptDeadReckoning
from msss_graphslam.core.scans.scan_generator import EARLY_PARTS, PART, ScanGenerator
from msss_graphslam.core.types import Beam, Odometry, Scan
from msss_graphslam.messages import encoding, link_decoding, topics
from msss_graphslam.ros.messages import make

SENT = dive(2.3)
MEASUREMENTS = [measurement_of(*one) for one in SENT]
BEAMS = [message for topic, message in SENT if topic is topics.SONAR_PING]


@pytest.fixture
def node() -> Iterator[Fed]:
    with fed("scan_generation") as feeder:
        for topic in (topics.SCAN, topics.SCAN_BEAMS, topics.SCAN_PART, topics.RECKONED_PATH):
            feeder.hear(topic)
        for topic in (topics.SONAR_PING, topics.SETTLED_ODOMETRY):
            feeder.offer(topic)
        yield feeder


def odometry() -> list[Odometry]:
    core = PromptDeadReckoning(Configuration(), Counter())
    answers = [core.process(measurement).settled for measurement in MEASUREMENTS]
    return [row for rows in [*answers, core.finish()] for row in rows]


def expected_scans() -> list[Scan]:
    core = ScanGenerator(Configuration(), Counter())
    scans = []
    for measurement in MEASUREMENTS:
        if isinstance(measurement, Beam):
            scans += core.add_beam(measurement)
    for entry in odometry():
        scans += core.add_odometry(entry)
    return scans + core.finish()


def send_odometry(node: Fed, rows: list[Odometry]) -> None:
    for first in range(0, len(rows), 10):
        part = rows[first : first + 10]
        message = encoding.settled_odometry(make, part[-1].stamp_ns, part)
        node.send(topics.SETTLED_ODOMETRY, message)


@pytest.mark.parametrize("beams_first", [True, False])
def test_scans_are_the_core_s_to_the_bit(node: Fed, beams_first: bool) -> None:
    if not beams_first:
        send_odometry(node, odometry())
    for message in BEAMS:
        node.send(topics.SONAR_PING, message)
    if beams_first:
        send_odometry(node, odometry())
    wait_until(lambda: len(node.heard(topics.SCAN_BEAMS)) == 2, "two whole turns")
    wait_until(lambda: node.trigger("save").success, "the rest made")
    expected = expected_scans()
    wait_until(lambda: len(node.heard(topics.SCAN_BEAMS)) == len(expected), "all scans")
    found = [link_decoding.scan_beams(message) for message in node.heard(topics.SCAN_BEAMS)]
    assert [scan.usable for scan in expected][:2] == [True, True]
    assert len(expected[0].points) > 30
    for scan, wanted in zip(found, expected, strict=True):
        for field in fields(Scan):
            np.testing.assert_array_equal(getattr(scan, field.name), getattr(wanted, field.name))
    usable = [scan for scan in expected if scan.usable]
    wait_until(lambda: len(node.heard(topics.SCAN)) == len(usable), "clouds")
    assert [cloud.width for cloud in node.heard(topics.SCAN)] == [len(s.points) for s in usable]


def test_of_each_turn_the_beginning_is_told_before_it_is_whole(node: Fed) -> None:
    send_odometry(node, odometry())
    for message in BEAMS:
        node.send(topics.SONAR_PING, message)
    wait_until(lambda: len(node.heard(topics.SCAN_BEAMS)) == 2, "two whole turns")
    wait_until(lambda: len(node.heard(topics.SCAN_PART)) > len(EARLY_PARTS), "their parts")
    parts = [link_decoding.scan_beams(message) for message in node.heard(topics.SCAN_PART)]
    scans = {scan.stamp_ns: scan for scan in expected_scans()}
    for part, share in zip(parts, np.array([PART, *EARLY_PARTS]) / (2.0 * np.pi), strict=False):
        scan = scans[part.stamp_ns]
        count = len(part.beam_stamps_ns)
        np.testing.assert_array_equal(part.beam_stamps_ns, scan.beam_stamps_ns[:count])
        assert count == pytest.approx(share * len(scan.beam_stamps_ns), abs=2)
        assert not part.complete


def test_save_waits_for_odometry_and_the_path_ends_with_the_newest(node: Fed) -> None:
    rows = odometry()
    for message in BEAMS:
        node.send(topics.SONAR_PING, message)
    wait_until(lambda: node.diagnostic("turns_waiting") == "2", "two turns held")
    send_odometry(node, rows[:20])
    wait_until(lambda: node.heard(topics.RECKONED_PATH), "a path")
    assert not node.heard(topics.SCAN_BEAMS)
    refused = node.trigger("save")
    assert (refused.success, refused.message) == (False, "waiting for odometry")
    send_odometry(node, rows[20:])
    wait_until(lambda: node.trigger("save").success, "the rest made")
    wait_until(
        lambda: (
            link_decoding.last_pose(node.heard(topics.RECKONED_PATH)[-1]).stamp_ns
            == rows[-1].stamp_ns
        ),
        "the whole path",
    )
    last = link_decoding.last_pose(node.heard(topics.RECKONED_PATH)[-1])
    np.testing.assert_allclose(last.pose, rows[-1].pose, atol=1e-9)


def test_a_beam_without_odometry_is_waited_for_but_not_for_ever(node: Fed) -> None:
    node.send(topics.SONAR_PING, BEAMS[0])
    wait_until(lambda: node.diagnostic("received/sonar/ping") == "1", "the beam taken")
    node.send(topics.SONAR_PING, BEAMS[1])
    answers = []

    def ask() -> bool:
        answers.append(node.trigger("save"))
        return bool(answers[-1].success)

    wait_until(ask, "saved")
    told = {one.message for one in answers[:-1]}
    assert {"waiting for odometry"} <= told
    assert told <= {"waiting for odometry", "waiting for beams of before the start"}


def test_started_again_it_goes_on_with_the_beams_that_were_kept() -> None:
    """What a predecessor has learned and made is neither missing nor made twice."""
    scans = expected_scans()
    with fed("scan_generation") as node:
        for topic in (topics.SONAR_PING, topics.SETTLED_ODOMETRY):
            node.offer(topic)
        for topic in (topics.RECENT_BEAMS, topics.SCANS_TAKEN):
            node.offer(topic)
        for topic in (topics.SCAN_BEAMS, topics.SCAN_PROGRESS):
            node.hear(topic)
        send_odometry(node, odometry())
        for message in BEAMS[-10:]:
            node.send(topics.SONAR_PING, message)
        for message in BEAMS[:-5]:
            node.send(topics.RECENT_BEAMS, message)
        node.send(topics.SCANS_TAKEN, encoding.moment(make, scans[0].end_stamp_ns))
        wait_until(lambda: node.trigger("save").success, "the rest made")
        wait_until(lambda: len(node.heard(topics.SCAN_BEAMS)) == len(scans) - 1, "all scans")
        found = [link_decoding.scan_beams(message) for message in node.heard(topics.SCAN_BEAMS)]
        for scan, wanted in zip(found, scans[1:], strict=True):
            for field in fields(Scan):
                ours, theirs = getattr(scan, field.name), getattr(wanted, field.name)
                np.testing.assert_array_equal(ours, theirs)
        told = link_decoding.moment(node.heard(topics.SCAN_PROGRESS)[-1])
        assert told > scans[-1].stamp_ns


def test_after_a_reset_nothing_is_resumed(node: Fed) -> None:
    assert node.trigger("reset").success
    for topic in (topics.RECENT_BEAMS, topics.SCANS_TAKEN):
        wait_until(lambda topic=topic: not node.listens_to(topic), f"{topic.name} ignored")
    send_odometry(node, odometry())
    for message in BEAMS:
        node.send(topics.SONAR_PING, message)
    wait_until(lambda: len(node.heard(topics.SCAN_BEAMS)) == 2, "two whole turns")
