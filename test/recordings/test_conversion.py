# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Foreign recordings: small ones written here by their documented definitions, and real ones."""

from collections import Counter
from math import cos, radians, sin
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rosbags.rosbag1 import Writer
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.types import Beam
from msss_graphslam.errors import UserError
from msss_graphslam.recordings.conversion import FORMATS, convert
from msss_graphslam.recordings.inspection import inspect
from msss_graphslam.recordings.mounting import Mounting
from msss_graphslam.recordings.reader import open_recording

REAL = Path(__file__).parents[3] / "shared" / "data"
START = 1_400_000_000
SCAN_LINE = """
std_msgs/Header header
float32 angle
float32 bin_distance_step
micron_driver_ros/IntensityBin[] bins
================================================================================
MSG: micron_driver_ros/IntensityBin
float32 distance
uint8 intensity
"""


def ros1_types() -> Any:
    types = get_typestore(Stores.ROS1_NOETIC)
    types.register(get_types_from_msg(SCAN_LINE, "micron_driver_ros/msg/ScanLine"))
    return types


TYPES = ros1_types()


def make(type_name: str, **fields: Any) -> Any:
    return TYPES.types[type_name](**fields)


def header(index: int) -> Any:
    stamp = make("builtin_interfaces/msg/Time", sec=START, nanosec=index * 40_000_000)
    return make("std_msgs/msg/Header", seq=index, stamp=stamp, frame_id="sonar")


def scan_line(index: int, angle: float, codes: list[int], step: float = 0.5) -> Any:
    bins = [
        make("micron_driver_ros/msg/IntensityBin", distance=step * (i + 1), intensity=code)
        for i, code in enumerate(codes)
    ]
    return make(
        "micron_driver_ros/msg/ScanLine",
        header=header(index),
        angle=angle,
        bin_distance_step=step,
        bins=bins,
    )


def cloud(index: int, angle: float, codes: list[float], edges: list[float], channel: str) -> Any:
    points = [
        make("geometry_msgs/msg/Point32", x=r * cos(angle), y=r * sin(angle), z=0.0) for r in edges
    ]
    values = np.array(codes, dtype=np.float32)
    named = make("sensor_msgs/msg/ChannelFloat32", name=channel, values=values)
    return make(
        "sensor_msgs/msg/PointCloud", header=header(index), points=points, channels=[named]
    )


def write_ros1(path: Path, messages: list[Any], topic: str = "/micron_driver/scan_line") -> Path:
    with Writer(path) as bag:
        connection = bag.add_connection(topic, messages[0].__msgtype__, typestore=TYPES)
        for index, message in enumerate(messages):
            data = TYPES.serialize_ros1(message, message.__msgtype__)
            bag.write(connection, START * 10**9 + index * 40_000_000, data)
    return path


def beams(path: Path) -> list[Beam]:
    refusals: Counter[str] = Counter()
    found = list(open_recording(path).measurements(refusals, Configuration()))
    assert not refusals
    return [beam for beam in found if isinstance(beam, Beam)]


@pytest.mark.parametrize(
    ("angle", "bearing"), [(180.0, 0.0), (-180.0, 0.0), (-90.0, -90.0), (90.0, 90.0), (0.0, 180.0)]
)
def test_a_seanet_angle_is_clockwise_from_astern(
    tmp_path: Path, angle: float, bearing: float
) -> None:
    source = write_ros1(tmp_path / "a.bag", [scan_line(0, angle, [1, 2])])
    convert(source, tmp_path / "out")
    [beam] = beams(tmp_path / "out")
    assert beam.bearing == pytest.approx(radians(bearing), abs=1e-6)


def test_scan_lines_become_beams(tmp_path: Path) -> None:
    lines = [scan_line(i, -180.0 + 1.8 * i, [0, 10, 255]) for i in range(5)]
    report = convert(write_ros1(tmp_path / "a.bag", lines), tmp_path / "out")
    assert (report.format, report.messages, report.refused) == ("robdos", {"/sonar/ping": 5}, {})
    found = beams(tmp_path / "out")
    np.testing.assert_allclose(found[0].ranges, [0.25, 0.75, 1.25])
    np.testing.assert_array_equal(found[0].intensities, [0, 10, 255])
    assert [beam.stamp_ns for beam in found] == [START * 10**9 + i * 40_000_000 for i in range(5)]
    np.testing.assert_allclose(np.diff([beam.bearing for beam in found]), -radians(1.8), atol=1e-6)
    raw = next(iter(open_recording(tmp_path / "out").messages()))
    assert raw.log_ns == START * 10**9


def test_clouds_become_beams(tmp_path: Path) -> None:
    edges = [0.5, 1.0, 1.5]
    clouds = [cloud(i, 0.1 * i - 3.0, [3.0, 2.0, 1.0], edges, "intensity") for i in range(4)]
    source = write_ros1(tmp_path / "a.bag", clouds, "/tritech_micron/scan")
    report = convert(source, tmp_path / "out.mcap")
    assert (report.format, report.messages) == ("mcgill", {"/sonar/ping": 4})
    found = beams(tmp_path / "out.mcap")
    np.testing.assert_allclose(found[0].ranges, [0.25, 0.75, 1.25])
    np.testing.assert_array_equal(found[0].intensities, [3.0, 2.0, 1.0])
    for index, beam in enumerate(found):
        ahead = np.exp(1j * beam.bearing) * np.exp(1j * (0.1 * index - 3.0))
        assert ahead == pytest.approx(-1.0, abs=1e-6)


BROKEN_LINES = [
    (scan_line(1, 0.0, []), "beam_without_bins"),
    (scan_line(1, float("nan"), [1]), "beam_bearing_not_finite"),
    (scan_line(1, 0.0, [1, 2], step=float("nan")), "beam_not_finite"),
    (scan_line(1, 0.0, [1, 2], step=0.0), "beam_ranges_not_increasing"),
]
BROKEN_CLOUDS = [
    (cloud(1, 0.0, [], [], "intensity"), "beam_without_bins"),
    (cloud(1, 0.0, [1.0], [0.5, 1.0], "intensity"), "beam_lengths_differ"),
    (cloud(1, 0.0, [1.0, 2.0], [0.5, 1.0], "colour"), "beam_without_intensities"),
    (cloud(1, 0.0, [1.0, 2.0], [0.5, 3.0], "intensity"), "beam_bins_not_regular"),
    (cloud(1, 0.0, [1.0, 2.0], [0.5, float("inf")], "intensity"), "beam_bins_not_regular"),
    (cloud(1, 0.0, [1.0, 300.0], [0.5, 1.0], "intensity"), "beam_intensity_out_of_range"),
]


@pytest.mark.parametrize(("broken", "reason"), BROKEN_LINES)
def test_scan_lines_that_are_refused(tmp_path: Path, broken: Any, reason: str) -> None:
    source = write_ros1(tmp_path / "a.bag", [scan_line(0, 0.0, [1]), broken])
    report = convert(source, tmp_path / "out")
    assert report.refused == {reason: 1}
    assert len(beams(tmp_path / "out")) == 1


@pytest.mark.parametrize(("broken", "reason"), BROKEN_CLOUDS)
def test_clouds_that_are_refused(tmp_path: Path, broken: Any, reason: str) -> None:
    good = cloud(0, 0.0, [1.0, 2.0], [0.5, 1.0], "intensity")
    report = convert(write_ros1(tmp_path / "a.bag", [good, broken]), tmp_path / "out")
    assert report.refused == {reason: 1}


def test_a_mounting_goes_into_the_bag(tmp_path: Path) -> None:
    offsets = tmp_path / "offsets.yaml"
    offsets.write_text("sonar: {mount_x: 0.3, mount_yaw: 3.0}")
    source = write_ros1(tmp_path / "a.bag", [scan_line(0, 0.0, [1])])
    convert(source, tmp_path / "out", Mounting.from_yaml(offsets))
    found = open_recording(tmp_path / "out").mounting()
    assert found is not None
    assert found.parameters == pytest.approx(
        {"sonar.mount_x": 0.3, "sonar.mount_y": 0.0, "sonar.mount_yaw": 3.0}
    )


@pytest.mark.parametrize(("value", "sense"), [("true", -1.0), ("false", 1.0)])
def test_a_head_upside_down_is_mirrored_but_for_its_mounting(
    tmp_path: Path, value: str, sense: float
) -> None:
    offsets = tmp_path / "offsets.yaml"
    offsets.write_text(f"sonar: {{mount_yaw: 0.5, inverted: {value}}}")
    clouds = [cloud(0, 1.0, [3.0, 2.0], [0.5, 1.0], "intensity")]
    for name, messages in (("a.bag", [scan_line(0, 60.0, [1])]), ("b.bag", clouds)):
        source = write_ros1(tmp_path / name, messages)
        convert(source, tmp_path / f"{name}.mcap", Mounting.from_yaml(offsets))
        [beam] = beams(tmp_path / f"{name}.mcap")
        angle = radians(60.0) if name == "a.bag" else 1.0
        assert beam.bearing == pytest.approx(sense * (np.pi - angle), abs=1e-6)
        found = open_recording(tmp_path / f"{name}.mcap").mounting()
        assert found is not None and found.mount_yaw == pytest.approx(0.5)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("", "must hold one group"),
        ("sonar: 3", "must hold one group"),
        ("sonar: {mount_x: 1}\nmapping: {}", "must hold one group"),
        ("sonar: {height: 1}", "unknown under sonar: height"),
        ("sonar: {mount_yaw: 9.0}", "must lie in"),
        ("sonar: {mount_x: left}", "must be of type float"),
        ("sonar: {inverted: 1}", "must be true or false"),
        ("sonar: {inverted: upside down}", "must be true or false"),
        ("a: [", "cannot be read as YAML"),
    ],
)
def test_offsets_that_are_none(tmp_path: Path, text: str, expected: str) -> None:
    path = tmp_path / "offsets.yaml"
    path.write_text(text)
    with pytest.raises(UserError, match=expected) as caught:
        Mounting.from_yaml(path)
    assert "\n" not in str(caught.value)


def test_nothing_usable_leaves_no_bag(tmp_path: Path) -> None:
    source = write_ros1(tmp_path / "a.bag", [scan_line(0, 0.0, [])])
    with pytest.raises(UserError, match=r"no usable beam.*beam_without_bins"):
        convert(source, tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_unknown_formats_are_told_the_known_ones(tmp_path: Path) -> None:
    path = tmp_path / "dive.log"
    path.write_text("hello")
    with pytest.raises(UserError, match=r"not known; known are: .*ScanLine"):
        convert(path, tmp_path / "out")
    with pytest.raises(UserError, match="No such file"):
        convert(tmp_path / "nothing.bag", tmp_path / "out")


def test_a_destination_is_never_overwritten(tmp_path: Path) -> None:
    source = write_ros1(tmp_path / "a.bag", [scan_line(0, 0.0, [1])])
    with pytest.raises(UserError, match="exists already"):
        convert(source, source)


def test_damaged_ros1_bags_end_in_one_line(tmp_path: Path) -> None:
    lines = [scan_line(i, 0.0, [1, 2, 3]) for i in range(20)]
    data = write_ros1(tmp_path / "a.bag", lines).read_bytes()
    path = tmp_path / "damaged.bag"
    failures = 0
    for index, length in enumerate(range(0, len(data), 211)):
        path.write_bytes(data[:length])
        destination = tmp_path / f"out{index}"
        with pytest.raises(UserError) as caught:
            convert(path, destination)
        assert "\n" not in str(caught.value) and not destination.exists()
        failures += 1
    assert failures > 10


def test_flipped_bytes_in_a_ros1_bag_end_in_one_line_or_a_bag(tmp_path: Path) -> None:
    lines = [scan_line(i, 0.0, [1, 2, 3]) for i in range(5)]
    data = write_ros1(tmp_path / "a.bag", lines).read_bytes()
    path = tmp_path / "damaged.bag"
    for index, position in enumerate(range(0, len(data), 53)):
        broken = bytearray(data)
        broken[position] ^= 0xFF
        path.write_bytes(broken)
        try:
            convert(path, tmp_path / f"out{index}")
        except UserError as error:
            assert "\n" not in str(error)


def test_every_format_has_a_name_of_its_own() -> None:
    names = [known.name for known in FORMATS]
    assert len(set(names)) == len(names) and all(known.description for known in FORMATS)


@pytest.mark.parametrize(
    ("name", "count", "bins", "maximum_range", "turn_time"),
    [
        ("robdos_micron/2014-07-18-21-02-59.bag", 2028, 200, 9.975, 8.57),
        ("timhw_micron/static_sonar.bag", 553, 396, 9.987, 9.0),
    ],
)
def test_real_recordings(
    tmp_path: Path, name: str, count: int, bins: int, maximum_range: float, turn_time: float
) -> None:
    source = REAL / name
    if not source.is_file():
        pytest.skip(f"{source} is not here: real recordings are not part of the project")
    report = convert(source, tmp_path / "out")
    assert (report.messages, report.refused) == ({"/sonar/ping": count}, {})
    sonar = inspect(tmp_path / "out").sonar
    assert sonar is not None
    assert (sonar.beams, sonar.bins, sonar.direction) == (count, bins, "clockwise")
    assert sonar.step == pytest.approx(radians(1.8), rel=1e-3)
    assert sonar.maximum_range == pytest.approx(maximum_range, abs=1e-3)
    assert sonar.turn_time == pytest.approx(turn_time, abs=0.2)
    assert sonar.settings_changes == 0
    codes = np.unique(np.concatenate([beam.intensities for beam in beams(tmp_path / "out")]))
    assert set(codes) <= set(np.floor(np.arange(125) * 255 / 160))
