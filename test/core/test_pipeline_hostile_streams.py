# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
from dataclasses import replace

import numpy as np
import pytest
from estimate_checks import assert_same_bytes, assert_sound
from small_mission import LAUNCH_NS, position_errors, recorded, run, seconds_of, until

from msss_graphslam.core.compounding import between
from msss_graphslam.core.recipes import ESTIMATORS
from msss_graphslam.core.types import (
    Beam,
    Depth,
    Inertial,
    Measurement,
)

EVERY_ESTIMATOR = pytest.mark.parametrize("estimator", list(ESTIMATORS))


@EVERY_ESTIMATOR
def test_no_measurements_at_all(estimator: str) -> None:
    estimate, refused = run([], estimator)
    assert_sound(estimate, 0)
    assert estimate.keyframes == ()
    assert not refused


def test_one_beam_only() -> None:
    (beam,) = [entry for entry in until(0.1) if isinstance(entry, Beam)][:1]
    estimate, _ = run([beam])
    assert_sound(estimate, 1)
    assert estimate.keyframes == ()


def test_no_beams_at_all() -> None:
    estimate, _ = run([entry for entry in until(20.0) if not isinstance(entry, Beam)])
    assert_sound(estimate, 0)


def test_shorter_than_the_alignment() -> None:
    estimate, _ = run(until(0.5))
    assert_sound(estimate, sum(isinstance(entry, Beam) for entry in until(0.5)))


@EVERY_ESTIMATOR
def test_without_an_imu_the_beams_alone_make_an_estimate(estimator: str) -> None:
    beams = [entry for entry in until(30.0) if isinstance(entry, Beam)]
    estimate, refused = run(beams, estimator)
    assert_sound(estimate, len(beams))
    assert len(estimate.keyframes) == 4
    assert not refused


def test_without_an_imu_full_finds_the_heading_by_the_walls() -> None:
    """On a course that turns slowly; where it starts from and heads to it cannot know."""
    mission = recorded(1, lap=1.0)
    beams = [entry for entry in mission.beams if seconds_of(entry) < 60.0]
    truth = mission.truth.planar[: len(beams)]
    errors = {}
    for name in ("dead_reckoning", "full"):
        planar = run(beams, name)[0].trajectory.planar
        away = between(planar[0], planar) - between(truth[0], truth)
        errors[name] = float(np.linalg.norm(away[:, :2], axis=1).mean())
    assert errors["full"] < 0.15 < errors["dead_reckoning"]


@pytest.mark.parametrize("missing", ["orientation", "angular_velocity"])
def test_half_an_imu_is_enough(missing: str) -> None:
    measurements = [
        replace(entry, **{missing: None}) if isinstance(entry, Inertial) else entry
        for entry in until(30.0)
    ]
    estimate, _ = run(measurements)
    assert_sound(estimate, sum(isinstance(entry, Beam) for entry in measurements))
    assert len(estimate.keyframes) == 4


def test_gaps_of_the_imu_are_bridged_by_the_beams() -> None:
    measurements = [
        entry
        for entry in recorded().measurements
        if not (isinstance(entry, Inertial) and 20.0 < seconds_of(entry) % 40.0 < 24.0)
    ]
    estimate, _ = run(measurements)
    assert_sound(estimate, len(recorded().beams))
    assert position_errors(estimate.trajectory, recorded().truth).mean() < 0.25


@EVERY_ESTIMATOR
def test_beams_without_any_echo(estimator: str) -> None:
    measurements = [
        replace(entry, intensities=np.zeros_like(entry.intensities))
        if isinstance(entry, Beam)
        else entry
        for entry in until(30.0)
    ]
    estimate, _ = run(measurements, estimator)
    assert_sound(estimate, sum(isinstance(entry, Beam) for entry in measurements))
    assert len(estimate.keyframes) == 4
    np.testing.assert_allclose(estimate.trajectory.poses, estimate.dead_reckoning.poses, atol=1e-6)


@pytest.mark.parametrize("code", [80, 255])
def test_beams_of_one_level_throughout(code: int) -> None:
    measurements = [
        replace(entry, intensities=np.full_like(entry.intensities, code))
        if isinstance(entry, Beam)
        else entry
        for entry in until(30.0)
    ]
    estimate, _ = run(measurements)
    assert_sound(estimate, sum(isinstance(entry, Beam) for entry in measurements))


def test_every_measurement_twice() -> None:
    once = until(30.0)
    twice = [entry for entry in once for _ in range(2)]
    estimate, refused = run(twice)
    beams = sum(isinstance(entry, Beam) for entry in once)
    assert refused == {"beam_not_newer": beams}
    assert_sound(estimate, beams)
    assert len(estimate.keyframes) == len(run(once)[0].keyframes)


def test_stamps_that_go_back_are_counted_and_left_out() -> None:
    measurements = until(30.0)
    late = [replace(entry, stamp_ns=entry.stamp_ns - 10**9) for entry in measurements[500:520]]
    with_late = measurements[:520] + late + measurements[520:]
    estimate, refused = run(with_late)
    assert refused == {"later_than_reorder_window": 20}
    assert_same_bytes(estimate, run(measurements)[0])


def test_a_silence_of_the_sonar_drops_the_turn_and_goes_on() -> None:
    measurements = [
        entry
        for entry in until(60.0)
        if not (isinstance(entry, Beam) and 20.0 < seconds_of(entry) < 25.0)
    ]
    estimate, refused = run(measurements)
    assert refused["turn_dropped_for_a_gap"] == 1
    assert refused["beams_in_dropped_turns"] > 0
    assert_sound(estimate, sum(isinstance(entry, Beam) for entry in measurements))
    assert position_errors(estimate.trajectory, recorded().truth).max() < 0.5


@pytest.mark.parametrize(("beams", "scans"), [(60, 3), (70, 4)])
def test_the_last_part_of_a_turn_from_both_sides(beams: int, scans: int) -> None:
    """The threshold is 2 rad, 64 steps of 1.8 degrees."""
    every = [entry for entry in recorded().measurements if isinstance(entry, Beam)]
    end = every[600 + beams].stamp_ns
    measurements = [entry for entry in recorded().measurements if entry.stamp_ns < end]
    estimate, _ = run(measurements)
    assert len(estimate.keyframes) == scans
    assert [keyframe.scan.complete for keyframe in estimate.keyframes[:3]] == [True] * 3
    assert estimate.keyframes[-1].scan.complete is (scans == 3)


@EVERY_ESTIMATOR
@pytest.mark.parametrize("at_once", [1, 3])
def test_a_head_that_shakes_instead_of_turning(estimator: str, at_once: int) -> None:
    """Every reversal ends a sweep; ``at_once`` beams share a stamp."""
    rng = np.random.default_rng(0)
    period_ns = 40_000_000
    measurements = [
        replace(entry, bearing=0.01 * rng.normal(), stamp_ns=LAUNCH_NS + k // at_once * period_ns)
        for k, entry in enumerate(recorded().beams[:90])
    ]
    estimate, refused = run(measurements, estimator)
    assert_sound(estimate, 90 // at_once)
    assert refused["beam_not_newer"] == 90 - 90 // at_once


def test_any_bearing_stamp_and_level_leaves_sound_numbers() -> None:
    rng = np.random.default_rng(1)
    ranges = 0.05 * (np.arange(200) + 0.5)
    measurements: list[Measurement] = []
    for number in range(1500):
        stamp = LAUNCH_NS + 20_000_000 * number + int(rng.integers(-(10**9), 10**8))
        kind = rng.integers(0, 3)
        if kind == 0:
            codes = rng.integers(0, 256, 200).astype(float)
            measurements.append(Beam(stamp, float(rng.uniform(-np.pi, np.pi)), ranges, codes))
        elif kind == 1:
            angles = rng.uniform(-np.pi, np.pi, 3)
            measurements.append(Inertial(stamp, angles, rng.normal(0.0, 10.0, 3)))
        else:
            measurements.append(Depth(stamp, float(rng.normal(0.0, 1e4))))
    estimate, refused = run(measurements)
    assert_sound(estimate, len(estimate.trajectory.stamps_ns))
    assert refused["later_than_reorder_window"] > 0
    beams = sum(isinstance(entry, Beam) for entry in measurements)
    assert 0 < len(estimate.trajectory.stamps_ns) < beams
