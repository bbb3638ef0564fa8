# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The segmentation on recordings of real heads, where these lie beside the repository."""

from pathlib import Path

import numpy as np
import pytest
from rectangle_fit import fit_rectangle
from rosbags.rosbag1 import Reader
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from msss_graphslam.config.groups import Segmentation, Sonar
from msss_graphslam.core.echoes.beam_segmentation import BeamSegmenter, reject_ghosts
from msss_graphslam.core.types import Beam

DATA = Path(__file__).resolve().parents[2].parent / "shared" / "data"
TURN = 200


def messages(path, topic):
    if not path.is_file():
        pytest.skip(f"the recording {path.name} is not here")
    store = get_typestore(Stores.ROS1_NOETIC)
    with Reader(path) as bag:
        connections = [c for c in bag.connections if c.topic == topic]
        for connection in connections:
            types = get_types_from_msg(connection.msgdef.data, connection.msgtype)
            store.register({k: v for k, v in types.items() if k not in store.fielddefs})
        for connection, stamp, raw in bag.messages(connections):
            yield stamp, store.deserialize_ros1(raw, connection.msgtype)


def segmented(beams):
    segmenter = BeamSegmenter(Sonar(), Segmentation())
    readings = [segmenter.segment(beam) for beam in beams]
    turns = [readings[start : start + TURN] for start in range(0, len(readings), TURN)]
    return [
        reading
        for turn in turns
        for reading in reject_ghosts(turn, Segmentation(), Sonar().beam_width)
    ]


def first_returns(readings):
    return np.array([r.ranges[0] if r.ranges.size else np.nan for r in readings])


def tank_beams():
    recording = messages(DATA / "timhw_micron" / "static_sonar.bag", "/tritech_micron/scan")
    for stamp, cloud in recording:
        codes = cloud.channels[0].values.astype(float)
        last = cloud.points[-1]
        bin_size = np.hypot(last.x, last.y) / codes.size
        ranges = (np.arange(codes.size) + 0.5) * bin_size
        yield Beam(stamp, float(np.arctan2(last.y, last.x)), ranges, codes)


@pytest.fixture(scope="module")
def tank():
    return segmented(tank_beams())


@pytest.mark.parametrize(("knots", "share"), [(1, 0.78), (3, 0.82), (25, 0.85)])
def test_first_returns_in_a_tank_lie_on_its_walls(tank, knots, share):
    ranges = first_returns(tank)
    fit = fit_rectangle(np.array([r.bearing for r in tank]), ranges, knots=knots)
    on_wall = fit.on_wall(ranges, 0.15)
    assert np.mean(on_wall) >= share
    assert fit.along_normal(ranges)[on_wall].std() <= 0.04


def test_the_stated_variance_is_that_of_the_tanks_walls(tank):
    ranges = first_returns(tank)
    fit = fit_rectangle(np.array([r.bearing for r in tank]), ranges, knots=25)
    across = fit.along_normal(ranges)[fit.on_wall(ranges, 0.15)]
    deviations = np.sqrt([r.variances[0] if r.ranges.size else np.nan for r in tank])
    assert 0.5 < across.std() / np.nanmedian(deviations) < 2.0


def pool_beams():
    recording = messages(
        DATA / "robdos_micron" / "2014-07-18-21-02-59.bag", "/micron_driver/scan_line"
    )
    for stamp, line in recording:
        codes = np.array([cell.intensity for cell in line.bins], dtype=float)
        ranges = (np.arange(codes.size) + 0.5) * line.bin_distance_step
        yield Beam(stamp, float(np.radians(line.angle)), ranges, codes)


@pytest.fixture(scope="module")
def pool():
    beams = list(pool_beams())
    return beams, first_returns(segmented(beams))


def hull_bearings(beams):
    """Which bearings ring after the transducer has died out: the hull is there."""
    ringing = np.array([np.median(beam.intensities[12:18]) for beam in beams]) * 80.0 / 255.0
    cells = np.round(np.degrees([beam.bearing for beam in beams]) / 1.8).astype(int)
    levels = {cell: np.median(ringing[cells == cell]) for cell in np.unique(cells)}
    return np.array([levels[cell] > 14.0 for cell in cells])


def test_the_hull_of_a_moving_vehicle_is_no_wall(pool):
    _, ranges = pool
    assert np.mean(ranges < 1.6) < 0.01


def test_ghosts_in_the_hull_s_shadow_go_and_walls_in_the_open_stay(pool):
    beams, ranges = pool
    hull = hull_bearings(beams)
    seen = np.isfinite(ranges)
    assert 0.3 < hull.mean() < 0.6
    assert seen[hull].mean() < 0.1
    assert seen[~hull].mean() > 0.5
