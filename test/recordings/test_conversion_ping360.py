# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""SonarEcho bags of the ping360_sonar driver, written here by its definition."""

from collections import Counter
from collections.abc import Callable
from itertools import pairwise
from math import inf, nan, pi, radians
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rosbags import rosbag1, rosbag2
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.recipes import ESTIMATORS
from msss_graphslam.core.types import Beam
from msss_graphslam.errors import UserError
from msss_graphslam.offline.estimation import estimate
from msss_graphslam.recordings.conversion import convert
from msss_graphslam.recordings.mounting import Mounting
from msss_graphslam.recordings.reader import open_recording

SONAR_ECHO = """
std_msgs/Header header
float32 angle
uint8 gain
uint16 number_of_samples
uint16 transmit_frequency
uint16 speed_of_sound
uint8 range
uint8[] intensities
"""
TYPE = "ping360_sonar_msgs/msg/SonarEcho"
START_NS = 1_650_000_000_000_000_000


def types(store: Stores, type_name: str = TYPE) -> Any:
    known = get_typestore(store)
    known.register(get_types_from_msg(SONAR_ECHO, type_name))
    return known


ROS2 = types(Stores.ROS2_JAZZY)


def echo(
    index: int, angle: float, codes: Any = (1, 2, 3), known: Any = ROS2, **fields: Any
) -> Any:
    stamp_ns = START_NS + index * 50_000_000
    header = {"seq": index} if known is not ROS2 else {}
    stamp = known.types["builtin_interfaces/msg/Time"](
        sec=stamp_ns // 10**9, nanosec=stamp_ns % 10**9
    )
    values = {
        "header": known.types["std_msgs/msg/Header"](stamp=stamp, frame_id="sonar", **header),
        "angle": angle,
        "gain": 0,
        "number_of_samples": len(codes),
        "transmit_frequency": 740,
        "speed_of_sound": 1500,
        "range": 3,
        "intensities": np.array(codes, dtype=np.uint8),
    }
    (name,) = (name for name in known.types if name.endswith("/SonarEcho"))
    return known.types[name](**{**values, **fields})


def write_ros2(path: Path, echoes: list[Any], plugin: Any = rosbag2.StoragePlugin.MCAP) -> Path:
    with rosbag2.Writer(path, version=9, storage_plugin=plugin) as bag:
        connection = bag.add_connection("/scan_echo", TYPE, typestore=ROS2)
        for index, message in enumerate(echoes):
            data = ROS2.serialize_cdr(message, TYPE)
            bag.write(connection, START_NS + index * 50_000_000, data)
    return path


def write_sqlite(path: Path, echoes: list[Any]) -> Path:
    return write_ros2(path, echoes, rosbag2.StoragePlugin.SQLITE3)


def write_file(path: Path, echoes: list[Any]) -> Path:
    [file] = write_ros2(path, echoes).glob("*.mcap")
    return file


def write_sqlite_file(path: Path, echoes: list[Any]) -> Path:
    [file] = write_sqlite(path, echoes).glob("*.db3")
    return file


def beams(path: Path) -> list[Beam]:
    refusals: Counter[str] = Counter()
    found = list(open_recording(path).measurements(refusals, Configuration()))
    assert not refusals
    return [entry for entry in found if isinstance(entry, Beam)]


WRITERS = [write_ros2, write_sqlite, write_file, write_sqlite_file]


@pytest.mark.parametrize("writer", WRITERS)
def test_echoes_become_beams(tmp_path: Path, writer: Callable[..., Path]) -> None:
    echoes = [echo(i, radians(0.9 * i), [0, 128, 255]) for i in range(5)]
    report = convert(writer(tmp_path / "in", echoes), tmp_path / "out")
    assert (report.format, report.messages, report.refused) == ("ping360", {"/sonar/ping": 5}, {})
    found = beams(tmp_path / "out")
    assert [beam.stamp_ns for beam in found] == [START_NS + i * 50_000_000 for i in range(5)]
    np.testing.assert_array_equal(found[0].intensities, [0, 128, 255])
    np.testing.assert_allclose(found[0].ranges, [0.5, 1.5, 2.5], rtol=1e-4)
    steps = [np.angle(np.exp(1j * (b.bearing - a.bearing))) for a, b in pairwise(found)]
    np.testing.assert_allclose(steps, -radians(0.9), atol=1e-6)


def test_the_ros1_driver_is_read_too(tmp_path: Path) -> None:
    known = types(Stores.ROS1_NOETIC, "ping360_sonar/msg/SonarEcho")
    with rosbag1.Writer(tmp_path / "in.bag") as bag:
        kind = "ping360_sonar/msg/SonarEcho"
        connection = bag.add_connection("/ping360_node/sonar/data", kind, typestore=known)
        message = echo(0, 200.0, known=known)
        bag.write(connection, START_NS, known.serialize_ros1(message, kind))
    report = convert(tmp_path / "in.bag", tmp_path / "out")
    assert report.messages == {"/sonar/ping": 1}
    assert beams(tmp_path / "out")[0].bearing == pytest.approx(0.0, abs=1e-6)


def test_a_bag_without_definitions_is_read_by_the_documented_one(tmp_path: Path) -> None:
    """As rosbag2 wrote sqlite3 before ROS 2 Iron."""
    source = write_sqlite_file(tmp_path / "in", [echo(0, 1.0)])
    import apsw

    database = apsw.Connection(str(source))
    database.execute("DROP TABLE message_definitions")
    database.execute("UPDATE schema SET schema_version = 3")
    database.close()
    assert convert(source, tmp_path / "out").messages == {"/sonar/ping": 1}


@pytest.mark.parametrize(
    ("angle", "bearing"), [(pi, 0), (-pi, 0), (0, pi), (pi / 2, pi / 2), (-pi / 2, -pi / 2)]
)
def test_angles_are_clockwise_from_astern(tmp_path: Path, angle: float, bearing: float) -> None:
    convert(write_ros2(tmp_path / "in", [echo(0, angle)]), tmp_path / "out")
    [beam] = beams(tmp_path / "out")
    assert np.exp(1j * beam.bearing) == pytest.approx(np.exp(1j * bearing), abs=1e-6)


def test_a_head_upside_down_turns_the_other_way(tmp_path: Path) -> None:
    source = write_ros2(tmp_path / "in", [echo(0, pi / 2)])
    convert(source, tmp_path / "out", Mounting(inverted=True))
    assert beams(tmp_path / "out")[0].bearing == pytest.approx(-pi / 2, abs=1e-6)


@pytest.mark.parametrize(("last", "is_radians"), [(6.28, True), (6.3, False), (-7.0, False)])
def test_one_angle_beyond_a_turn_makes_all_of_them_gradians(
    tmp_path: Path, last: float, is_radians: bool
) -> None:
    convert(write_ros2(tmp_path / "in", [echo(0, 2.0), echo(1, last)]), tmp_path / "out")
    expected = pi - (2.0 if is_radians else 2.0 * pi / 200)
    assert beams(tmp_path / "out")[0].bearing == pytest.approx(expected, abs=1e-6)


def test_bins_are_as_long_as_the_head_sampled(tmp_path: Path) -> None:
    """2 m in 1200 samples are 88.9 ticks of 25 ns; the driver asks for 88."""
    message = echo(0, 1.0, [7] * 1200, range=2)
    convert(write_ros2(tmp_path / "in", [message]), tmp_path / "out")
    [beam] = beams(tmp_path / "out")
    length = 88 * 25e-9 * 1500 / 2
    np.testing.assert_allclose(beam.ranges, (np.arange(1200) + 0.5) * length, rtol=1e-5)


BROKEN = [
    ({"angle": nan}, "beam_bearing_not_finite"),
    ({"angle": -inf}, "beam_bearing_not_finite"),
    ({"codes": []}, "beam_without_bins"),
    ({"number_of_samples": 4}, "beam_lengths_differ"),
    ({"range": 0}, "beam_ranges_not_increasing"),
    ({"speed_of_sound": 0}, "beam_without_sound_speed"),
]


@pytest.mark.parametrize(("fields", "reason"), BROKEN)
def test_echoes_that_are_refused(tmp_path: Path, fields: dict[str, Any], reason: str) -> None:
    echoes = [echo(0, 1.0), echo(1, **{"angle": 1.0, **fields})]
    report = convert(write_ros2(tmp_path / "in", echoes), tmp_path / "out")
    assert report.refused == {reason: 1} and len(beams(tmp_path / "out")) == 1
    assert beams(tmp_path / "out")[0].bearing == pytest.approx(pi - 1.0, abs=1e-6)


@pytest.mark.parametrize("writer", [write_file, write_sqlite_file])
def test_cut_files_end_in_one_line_or_a_bag(tmp_path: Path, writer: Callable[..., Path]) -> None:
    source = writer(tmp_path / "in", [echo(i, 1.0) for i in range(3)])
    data = source.read_bytes()
    cut = tmp_path / f"cut{source.suffix}"
    for number, length in enumerate(range(0, len(data), max(len(data) // 100, 1))):
        cut.write_bytes(data[:length])
        ends_in_one_line_or_a_bag(cut, tmp_path / f"out{number}.mcap")


@pytest.mark.slow
@pytest.mark.parametrize("writer", [write_file, write_sqlite_file])
def test_flipped_bytes_end_in_one_line_or_a_bag(
    tmp_path: Path, writer: Callable[..., Path]
) -> None:
    source = writer(tmp_path / "in", [echo(i, 1.0) for i in range(3)])
    data = source.read_bytes()
    broken = tmp_path / f"broken{source.suffix}"
    for number, position in enumerate(range(0, len(data), max(len(data) // 120, 1))):
        flipped = bytearray(data)
        flipped[position] ^= 0xFF
        broken.write_bytes(flipped)
        ends_in_one_line_or_a_bag(broken, tmp_path / f"out{number}.mcap")


def ends_in_one_line_or_a_bag(source: Path, destination: Path) -> None:
    try:
        report = convert(source, destination)
    except UserError as error:
        assert "\n" not in str(error) and not destination.exists()
    else:
        assert 1 <= len(beams(destination)) <= 3
        assert report.messages["/sonar/ping"] == len(beams(destination))


@pytest.mark.parametrize("name", ["metadata.yaml", "in.db3", "in.mcap"])
def test_folders_and_files_that_are_no_bag(tmp_path: Path, name: str) -> None:
    folder = tmp_path / "in"
    folder.mkdir()
    (folder / name).write_text("rosbag2_bagfile_information: 3")
    for source in (folder, folder / name):
        with pytest.raises(UserError) as caught:
            convert(source, tmp_path / "out")
        assert "\n" not in str(caught.value)


def test_a_bag_of_other_topics_is_told_the_known_formats(tmp_path: Path) -> None:
    with rosbag2.Writer(tmp_path / "in", version=9) as bag:
        bag.add_connection("/scan", "sensor_msgs/msg/LaserScan", typestore=ROS2)
    with pytest.raises(UserError, match=r"the format is not known; known are: .*SonarEcho"):
        convert(tmp_path / "in", tmp_path / "out")


@pytest.mark.slow
def test_a_converted_bag_runs(tmp_path: Path) -> None:
    random = np.random.default_rng(1)
    echoes = []
    for index in range(450):
        codes = random.integers(0, 40, 200)
        codes[120:130] = 230
        echoes.append(echo(index, radians(1.8 * (index % 200) - 180.0), codes, range=10))
    convert(write_ros2(tmp_path / "in", echoes), tmp_path / "out")
    recording = open_recording(tmp_path / "out")
    record = estimate(recording, ESTIMATORS["full"], Configuration(), lambda _share, _what: None)
    assert not record.refused and np.isfinite(record.estimate.trajectory.poses).all()
    assert len(record.estimate.trajectory.poses) == 450
    distances = np.hypot(*record.points[:, :2].T)
    assert len(distances) > 100 and 5.0 < np.median(distances) < 8.0
