# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Inspection: what is in a bag, what is missing, and what that costs."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from sample_bags import BEAM_PERIOD_NS, START_NS, STEP, beam_message, sensor_messages, write_bag

from msss_graphslam.core.types import Inertial
from msss_graphslam.errors import UserError
from msss_graphslam.messages import encoding
from msss_graphslam.recordings.inspection import inspect
from msss_graphslam.recordings.typestore import make

PERIOD = BEAM_PERIOD_NS * 1e-9


def pings(count: int = 100, **changes: Any) -> list[tuple[str, Any, int]]:
    return [
        ("/sonar/ping", beam_message(index, **changes), START_NS + index * BEAM_PERIOD_NS)
        for index in range(count)
    ]


def test_a_complete_bag(tmp_path: Path) -> None:
    report = inspect(write_bag(tmp_path / "dive"))
    assert report.can_run and report.lacks == () and report.refused == {}
    assert report.duration == pytest.approx(49 * PERIOD)
    ping = next(topic for topic in report.topics if topic.name == "/sonar/ping")
    assert (ping.count, ping.gap_count) == (50, 0)
    assert ping.rate == pytest.approx(25.0)
    assert ping.type_name == "sensor_msgs/msg/LaserScan"


@pytest.mark.parametrize(
    ("step", "direction"), [(STEP, "counter-clockwise"), (-STEP, "clockwise")]
)
def test_a_turning_head(tmp_path: Path, step: float, direction: str) -> None:
    sonar = inspect(write_bag(tmp_path / "dive", pings(300, step=step))).sonar
    assert sonar is not None
    assert sonar.direction == direction
    assert sonar.step == pytest.approx(STEP, rel=1e-4)
    assert sonar.turn_time == pytest.approx(200 * PERIOD, rel=1e-4)
    assert sonar.turns == pytest.approx(299 / 200, rel=1e-4)
    assert (sonar.bins, sonar.settings_changes) == (20, 0)
    assert sonar.maximum_range == pytest.approx(0.975)
    assert sonar.bin_length == pytest.approx(0.05)
    assert sonar.beam_period == pytest.approx(PERIOD)


def test_a_sector_has_no_turn_time(tmp_path: Path) -> None:
    messages = []
    for index in range(100):
        message = beam_message(index)
        message.angle_min = message.angle_max = 0.01 * abs(index % 40 - 20)
        messages.append(("/sonar/ping", message, START_NS + index * BEAM_PERIOD_NS))
    sonar = inspect(write_bag(tmp_path / "dive", messages)).sonar
    assert sonar is not None
    assert (sonar.direction, sonar.turn_time) == ("sector", None)


def test_one_beam_stands_still(tmp_path: Path) -> None:
    sonar = inspect(write_bag(tmp_path / "dive", pings(1, bins=1))).sonar
    assert sonar is not None
    assert (sonar.direction, sonar.turn_time, sonar.beams, sonar.bins) == ("still", None, 1, 1)


def test_changed_settings_are_counted_and_the_usual_ones_told(tmp_path: Path) -> None:
    messages = pings(30)
    messages[10:15] = pings(30, bins=40)[10:15]
    sonar = inspect(write_bag(tmp_path / "dive", messages)).sonar
    assert sonar is not None
    assert (sonar.settings_changes, sonar.bins) == (2, 20)


@pytest.mark.parametrize(("missing", "gaps"), [(2, 0), (3, 1)])
def test_gaps_from_both_sides_of_the_threshold(tmp_path: Path, missing: int, gaps: int) -> None:
    messages = pings(100)
    del messages[50 : 50 + missing]
    topic = inspect(write_bag(tmp_path / "dive", messages)).topics[0]
    assert topic.gap_count == len(topic.longest_gaps) == gaps
    for gap in topic.longest_gaps:
        assert gap.start == pytest.approx(49 * PERIOD)
        assert gap.duration == pytest.approx(4 * PERIOD)


def test_what_is_missing_and_what_it_costs(tmp_path: Path) -> None:
    lacks = {lack.name: lack.cost for lack in inspect(write_bag(tmp_path / "a", pings())).lacks}
    assert set(lacks) == {"/imu/data", "/pressure", "/dvl/twist", "/ground_truth"}
    assert "scan matching only" in lacks["/imu/data"]


@pytest.mark.parametrize(
    ("sample", "lack"),
    [
        (Inertial(START_NS, np.zeros(3), None), "imu angular velocity"),
        (Inertial(START_NS, None, np.zeros(3)), "imu orientation"),
    ],
)
def test_half_an_imu(tmp_path: Path, sample: Inertial, lack: str) -> None:
    messages = [*pings(), ("/imu/data", encoding.imu(make, sample, "imu_link"), START_NS)]
    assert lack in {lack.name for lack in inspect(write_bag(tmp_path / "dive", messages)).lacks}


def test_a_bag_that_cannot_run_says_why(tmp_path: Path) -> None:
    others = [entry for entry in sensor_messages(5) if entry[0] != "/sonar/ping"]
    report = inspect(write_bag(tmp_path / "dive", others))
    assert not report.can_run and "no topic /sonar/ping" in report.problem
    assert report.sonar is None


def test_a_bag_of_useless_beams_cannot_run(tmp_path: Path) -> None:
    messages = pings(3)
    for _, message, _ in messages:
        message.angle_min = message.angle_max = float("nan")
    report = inspect(write_bag(tmp_path / "dive", messages))
    assert "not one beam" in report.problem
    assert report.refused == {"beam_bearing_not_finite": 3}


def test_the_report_is_plain_json(tmp_path: Path) -> None:
    text = json.dumps(inspect(write_bag(tmp_path / "dive")).as_dict(), allow_nan=False)
    content = json.loads(text)
    assert content["can_run"] is True
    assert content["sonar"]["beams"] == 50
    assert content["damage"]["truncated"] is False


def test_no_bag_is_a_user_error(tmp_path: Path) -> None:
    with pytest.raises(UserError):
        inspect(tmp_path / "nothing")
