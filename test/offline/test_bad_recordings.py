# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Recordings with faults in them: each fault is counted, nothing is made up, the rest is used."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.recipes import ESTIMATORS
from msss_graphslam.evaluation.errors import position_errors
from msss_graphslam.offline.estimation import estimate
from msss_graphslam.recordings.reader import open_recording
from msss_graphslam.recordings.typestore import TYPES
from msss_graphslam.recordings.writer import BagWriter
from msss_graphslam.results.record import RunRecord
from msss_graphslam.simulation.recording import SimulatedBag

pytestmark = pytest.mark.slow


@dataclass
class Recorded:
    """A message of the tank's bag; ``number`` counts those of its topic."""

    topic: str
    number: int
    message: Any
    log_ns: int


Fault = Callable[[Recorded], Iterator[Recorded]]


@pytest.fixture(scope="module")
def recorded(tank: SimulatedBag) -> list[tuple[str, str, bytes, int]]:
    """The raw messages of the tank's bag."""
    return [
        (raw.channel.topic, raw.schema.name, raw.data, raw.log_ns)
        for raw in open_recording(tank.bag).messages()
        if raw.schema is not None
    ]


def run_with(fault: Fault, recorded: list[Any], folder: Path) -> RunRecord:
    """Run the default estimator over the tank's bag with a fault in it."""
    counts: dict[str, int] = {}
    with BagWriter(folder / "faulty") as bag:
        for topic, type_name, data, log_ns in recorded:
            message = TYPES.deserialize_cdr(data, type_name)
            number = counts[topic] = counts.get(topic, -1) + 1
            for entry in fault(Recorded(topic, number, message, log_ns)):
                bag.write(entry.topic, entry.message, entry.log_ns)
    recording = open_recording(folder / "faulty")
    return estimate(recording, ESTIMATORS["full"], Configuration(), lambda _share, _what: None)


def assert_sound(record: RunRecord, worst: float) -> None:
    """Assert that everything is finite and the trajectory still fits the truth."""
    result = record.estimate
    for trajectory in (result.trajectory, result.online, result.dead_reckoning):
        assert np.isfinite(trajectory.poses).all()
        assert (np.diff(trajectory.stamps_ns) > 0).all()
    assert np.isfinite(record.points).all()
    assert record.truth is not None
    assert position_errors(result.trajectory, record.truth).anchored.max() < worst


def every(count: int, topic: str, change: Callable[[Any], None]) -> Fault:
    """Change every count-th message of a topic."""

    def fault(entry: Recorded) -> Iterator[Recorded]:
        if entry.topic == topic and entry.number % count == count - 1:
            change(entry.message)
        yield entry

    return fault


def set_orientation(*values: float) -> Callable[[Any], None]:
    def change(message: Any) -> None:
        for name, value in zip("xyzw", values, strict=True):
            setattr(message.orientation, name, value)

    return change


def spoil_rates(message: Any) -> None:
    message.angular_velocity.z = float("inf")


def spoil_codes(message: Any) -> None:
    message.intensities = np.full_like(message.intensities, np.nan)


def take_bins_out(message: Any) -> None:
    message.ranges = message.intensities = np.zeros(0, np.float32)


def spoil_pressure(message: Any) -> None:
    message.fluid_pressure = float("nan")


def set_back(message: Any) -> None:
    message.header.stamp.sec -= 20


@pytest.mark.parametrize(
    ("topic", "change", "sensor"),
    [
        ("/imu/data", set_orientation(*[float("nan")] * 4), "imu"),
        ("/imu/data", set_orientation(0.0, 0.0, 0.0, 0.0), "imu"),
        ("/imu/data", spoil_rates, "imu"),
        ("/sonar/ping", spoil_codes, "beam"),
        ("/sonar/ping", take_bins_out, "beam"),
        ("/pressure", spoil_pressure, "pressure"),
        ("/sonar/ping", set_back, ""),
        ("/imu/data", set_back, ""),
    ],
    ids=[
        "orientation_nan",
        "orientation_zero",
        "rates_infinite",
        "codes_nan",
        "beam_without_bins",
        "pressure_nan",
        "beam_set_back",
        "imu_set_back",
    ],
)
def test_every_fault_is_counted_and_the_rest_is_used(
    recorded: list[Any],
    tmp_path: Path,
    topic: str,
    change: Callable[[Any], None],
    sensor: str,
) -> None:
    record = run_with(every(50, topic, change), recorded, tmp_path)
    faults = sum(name == topic for name, *_ in recorded) // 50
    assert sum(n for reason, n in record.refused.items() if sensor in reason) >= faults
    assert_sound(record, worst=0.3)


def test_a_beam_that_comes_twice_is_counted(recorded: list[Any], tmp_path: Path) -> None:
    def fault(entry: Recorded) -> Iterator[Recorded]:
        yield entry
        if entry.topic == "/sonar/ping" and entry.number % 50 == 49:
            yield entry

    record = run_with(fault, recorded, tmp_path)
    assert (
        sum(record.refused.values()) >= sum(name == "/sonar/ping" for name, *_ in recorded) // 50
    )
    assert_sound(record, worst=0.3)


def test_a_bearing_that_jumps_drops_the_turn_and_counts_it(
    recorded: list[Any], tmp_path: Path
) -> None:
    def fault(entry: Recorded) -> Iterator[Recorded]:
        if entry.topic == "/sonar/ping" and 400 <= entry.number < 420:
            entry.message.angle_min += 1.5
            entry.message.angle_max = entry.message.angle_min
        yield entry

    record = run_with(fault, recorded, tmp_path)
    assert sum(record.refused.values()) > 0
    assert_sound(record, worst=0.5)


def without(*topics: str) -> Fault:
    """Leave topics out."""

    def fault(entry: Recorded) -> Iterator[Recorded]:
        if entry.topic not in topics:
            yield entry

    return fault


def test_without_an_imu_the_heading_comes_from_the_sonar(
    recorded: list[Any], tmp_path: Path
) -> None:
    record = run_with(without("/imu/data"), recorded, tmp_path)
    assert any(line.startswith("/imu/data: heading comes from") for line in record.bag.missing)
    assert np.isfinite(record.estimate.trajectory.poses).all()


def test_without_a_pressure_sensor_the_depth_stays_unknown(
    recorded: list[Any], tmp_path: Path
) -> None:
    record = run_with(without("/pressure"), recorded, tmp_path)
    assert_sound(record, worst=0.3)
    assert any(line.startswith("/pressure: ") for line in record.bag.missing)


def test_without_a_truth_no_error_is_made_up(recorded: list[Any], tmp_path: Path) -> None:
    record = run_with(without("/ground_truth"), recorded, tmp_path)
    assert record.truth is None


def test_the_truth_changes_no_estimate(recorded: list[Any], tmp_path: Path) -> None:
    (tmp_path / "with").mkdir()
    (tmp_path / "without").mkdir()
    seen = run_with(without(), recorded, tmp_path / "with").estimate.trajectory
    blind = run_with(without("/ground_truth"), recorded, tmp_path / "without").estimate.trajectory
    assert np.array_equal(seen.poses, blind.poses)
