# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation as Attitude
from simulated_scenes import FAR_AWAY, SETTINGS, SQUARE, basin, levels, resting

from msss_graphslam.errors import UserError
from msss_graphslam.simulation.echo_model import EchoKind
from msss_graphslam.simulation.settings import Rotation, SonarSettings
from msss_graphslam.simulation.sonar import SonarRecord, pings_from, scan
from msss_graphslam.simulation.vehicle import Motion


def record(
    settings: SonarSettings = SETTINGS,
    echo: EchoKind = EchoKind.IDEAL,
    motion: Motion | None = None,
    seed: int = 1,
) -> SonarRecord:
    world = basin(SQUARE, settings)
    return scan(world, motion or resting(20.0), settings, echo, seed, lambda _: None)


@pytest.mark.parametrize(
    ("rotation", "sign"), [(Rotation.COUNTER_CLOCKWISE, 1.0), (Rotation.CLOCKWISE, -1.0)]
)
def test_the_head_turns_in_exact_steps_its_own_way(rotation: Rotation, sign: float) -> None:
    bearings = replace(SETTINGS, rotation=rotation).bearings(500, 37)
    steps = np.mod(np.diff(bearings) + np.pi, 2.0 * np.pi) - np.pi
    np.testing.assert_allclose(steps, sign * SETTINGS.step, atol=1e-8)
    np.testing.assert_allclose(bearings[:200], bearings[200:400], atol=1e-9)
    assert bearings.min() >= -np.pi
    assert bearings.max() < np.pi


@given(width=st.floats(10.0, 300.0), centre=st.floats(-180.0, 180.0), first=st.integers(0, 400))
def test_a_sector_is_swept_to_and_fro(width: float, centre: float, first: int) -> None:
    settings = replace(SETTINGS, sector=np.radians(width), sector_centre=np.radians(centre))
    bearings = settings.bearings(400, first)
    off = np.mod(bearings - settings.sector_centre + np.pi, 2.0 * np.pi) - np.pi
    assert np.abs(off).max() <= np.radians(width) / 2.0 + 1e-8
    np.testing.assert_allclose(np.abs(np.diff(off)), settings.step, atol=1e-8)
    assert {1.0, -1.0} <= set(np.sign(np.diff(off)).tolist())


@pytest.mark.parametrize("echo", EchoKind)
def test_beams_show_the_square_room_around_the_vehicle(echo: EchoKind) -> None:
    yaw = 0.4
    result = record(replace(SETTINGS, hull_sector=0.0), echo, resting(20.0, yaw))
    direction = result.bearings + yaw
    expected = 6.0 / np.maximum(np.abs(np.cos(direction)), np.abs(np.sin(direction)))
    heard = levels(result.codes)[:, 40:180]
    error = SETTINGS.ranges[40:180][heard.argmax(axis=1)] - expected
    assert abs(np.median(error)) < 0.06
    assert np.mean(np.abs(error) < 0.3) > 0.75


def test_a_misaligned_head_turns_the_picture() -> None:
    straight = record(motion=resting(20.0, 0.2))
    turned = record(replace(SETTINGS, mount_yaw=0.2))
    np.testing.assert_array_equal(straight.codes, turned.codes)


def test_stamps_are_late_by_a_millisecond_and_in_order() -> None:
    result = record()
    late = result.times - SETTINGS.beam_period * np.arange(len(result.times))
    assert late.min() >= 0.0
    assert 0.3e-3 < late.mean() < 1.5e-3
    assert np.diff(result.times).min() > 0.9 * SETTINGS.beam_period - 0.005


def test_each_beam_is_sent_from_where_the_vehicle_is_then() -> None:
    motion = resting(60.0)
    motion.poses[:, 0] = 0.05 * motion.times
    result = record(motion=motion)
    ahead = np.abs(result.bearings) < 1e-8
    heard = levels(result.codes[ahead])[:, 40:180]
    ranges = SETTINGS.ranges[40:180][heard.argmax(axis=1)]
    expected = 6.0 - 0.05 * result.times[ahead]
    assert np.median(np.abs(ranges - expected)) < 0.06


@given(
    roll=st.floats(-0.3, 0.3), pitch=st.floats(-0.3, 0.3), yaw=st.floats(-3.0, 3.0),
    bearing=st.floats(-3.1, 3.1),
)  # fmt: skip
def test_a_tilted_beam_points_along_the_level_line_of_its_plane(
    roll: float, pitch: float, yaw: float, bearing: float
) -> None:
    pose = np.array([[0.0, 0.0, 0.0, roll, pitch, yaw]])
    azimuth = pings_from(pose, np.array([bearing]), 0.0).azimuths[0]
    level_line = np.array([np.cos(azimuth), np.sin(azimuth), 0.0])
    attitude = Attitude.from_euler("ZYX", [yaw, pitch, roll])
    normal = attitude.apply([-np.sin(bearing), np.cos(bearing), 0.0])
    forward = attitude.apply([np.cos(bearing), np.sin(bearing), 0.0])
    assert level_line @ normal == pytest.approx(0.0, abs=1e-9)
    assert level_line @ forward > 0.5


def test_progress_rises_to_one() -> None:
    seen: list[float] = []
    world = basin(FAR_AWAY, SETTINGS)
    scan(world, resting(60.0), SETTINGS, EchoKind.IDEAL, 1, seen.append)
    assert seen == sorted(seen)
    assert len(seen) > 2
    assert seen[-1] == 1.0


@pytest.mark.parametrize(
    ("change", "complaint"),
    [
        ({"bins": 0}, "sonar bins = 0"),
        ({"maximum_range": -1.0}, "maximum_range = -1.0"),
        ({"step": float("nan")}, "step = nan"),
        ({"sector": 7.0}, "at most a full turn"),
        ({"sector": 0.01}, "at least one step"),
        ({"maximum_range": 50.0}, "too short for echoes from 50 m"),
    ],
)
def test_settings_without_sense_are_refused(change: dict[str, float], complaint: str) -> None:
    with pytest.raises(UserError, match=complaint):
        replace(SETTINGS, **change)


def test_the_beam_period_may_just_cover_the_range() -> None:
    assert replace(SETTINGS, maximum_range=30.0, beam_period=0.04).bin_length == 0.15
