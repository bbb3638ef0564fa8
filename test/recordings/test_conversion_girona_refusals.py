# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What of a bag of the Girona caves data set is refused, and how it is told."""

from math import nan
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from girona_bags import (
    PACKAGE,
    START_NS,
    converted,
    depth,
    dvl,
    good_scan,
    header,
    imu,
    make,
    scan,
    write,
)

from msss_graphslam.errors import UserError
from msss_graphslam.recordings.conversion import convert

BROKEN_SCANS = [
    (scan(START_NS, nan, [0.5, 1.0], [1, 2]), "beam_bearing_not_finite"),
    (scan(START_NS, 0.0, [0.5, nan], [1, 2]), "beam_bins_not_regular"),
    (scan(START_NS, 0.0, [0.5, 2.0], [1, 2]), "beam_bins_not_regular"),
    (scan(START_NS, 0.0, [9.5, 10.0], [1, 2]), "beam_bins_not_regular"),
    (scan(START_NS, 0.0, [0.5, 1.0, 1.2], [1, 2, 3]), "beam_bins_not_regular"),
    (scan(START_NS, 0.0, [1.0, 0.5], [1, 2]), "beam_bins_not_regular"),
    (scan(START_NS, 0.0, [0.0, 0.0], [1, 2]), "beam_bins_not_regular"),
    (scan(START_NS, 0.0, [], [1, 2], maximum=nan), "beam_bins_not_regular"),
    (scan(START_NS, 0.0, [], [1, 2], maximum=0.0), "beam_bins_not_regular"),
    (scan(START_NS, 0.0, [], []), "beam_without_bins"),
    (scan(START_NS, 0.0, [0.5, 1.0], [1, 256]), "beam_intensity_out_of_range"),
    (scan(-(10**9), 0.0, [0.5, 1.0], [1, 2]), "beam_stamp_invalid"),
]
ZEROS = np.zeros(3)
BROKEN_OTHERS = [
    ("/imu_adis", make(f"{PACKAGE}/Imu", header=header(START_NS)), "imu_quaternion_zero"),
    ("/imu_adis", imu(START_NS, ZEROS, [nan, 0, 0]), "imu_not_finite"),
    ("/imu_adis", imu(-(10**9), ZEROS, ZEROS), "imu_stamp_invalid"),
    ("/imu_adis", depth(START_NS, 1.0), "imu_data_undecodable"),
    ("/depth_sensor", depth(START_NS, nan), "pressure_not_finite"),
    ("/depth_sensor", depth(START_NS, -2e4), "pressure_out_of_range"),
    ("/dvl_linkquest", dvl(START_NS, ZEROS, flag=0), "dvl_without_bottom"),
    ("/dvl_linkquest", dvl(START_NS, ZEROS, flag=2), "dvl_without_bottom"),
    ("/dvl_linkquest", dvl(START_NS, [0, nan, 0]), "dvl_not_finite"),
]


@pytest.mark.parametrize(("message", "reason"), BROKEN_SCANS)
def test_scans_that_are_refused(tmp_path: Path, message: Any, reason: str) -> None:
    entries = [good_scan(), ("/sonar_micron_ros", message, START_NS)]
    report, found = converted(tmp_path, entries)
    assert report.refused == {reason: 1} and len(found) == 1


@pytest.mark.parametrize(("topic", "message", "reason"), BROKEN_OTHERS)
def test_samples_that_are_refused(tmp_path: Path, topic: str, message: Any, reason: str) -> None:
    report, found = converted(tmp_path, [good_scan(), (topic, message, START_NS)])
    assert report.refused == {reason: 1} and len(found) == 1


def test_without_a_beam_there_is_no_bag(tmp_path: Path) -> None:
    broken = ("/sonar_micron_ros", scan(START_NS, nan, [1.0], [1]), START_NS)
    source = write(tmp_path / "caves.bag", [broken, ("/depth_sensor", depth(0, 1.0), START_NS)])
    with pytest.raises(UserError, match=r"no usable beam.*beam_bearing_not_finite"):
        convert(source, tmp_path / "out")
    assert not (tmp_path / "out").exists()
