# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Reading whole bags: what comes out, in which order, and what is refused."""

from collections import Counter
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from sample_bags import BEAM_PERIOD_NS, START_NS, beam_message, sensor_messages, write_bag

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.types import Beam, BodyVelocity, Depth, Inertial, Measurement
from msss_graphslam.errors import UserError
from msss_graphslam.recordings.mounting import Mounting
from msss_graphslam.recordings.reader import open_recording
from msss_graphslam.recordings.typestore import make


def read(path: Path, **changes: Any) -> tuple[list[Measurement], Counter[str]]:
    refusals: Counter[str] = Counter()
    configuration = Configuration().with_values(changes)
    return list(open_recording(path).measurements(refusals, configuration)), refusals


def pings(indices: Iterable[int]) -> list[tuple[str, Any, int]]:
    return [
        ("/sonar/ping", beam_message(index), START_NS + order * BEAM_PERIOD_NS)
        for order, index in enumerate(indices)
    ]


@pytest.mark.parametrize("name", ["dive", "dive.mcap"])
def test_all_measurements_come_back(tmp_path: Path, name: str) -> None:
    recording = open_recording(write_bag(tmp_path / name))
    assert not recording.damage
    assert {topic.name: topic.count for topic in recording.topics.values()} == dict.fromkeys(
        ["/dvl/twist", "/ground_truth", "/imu/data", "/pressure", "/sonar/ping"], 50
    )
    assert (recording.start_ns, recording.end_ns) == (START_NS, START_NS + 49 * BEAM_PERIOD_NS)
    measurements, refusals = read(tmp_path / name)
    assert not refusals
    assert Counter(type(m) for m in measurements) == dict.fromkeys(
        [Beam, Inertial, Depth, BodyVelocity], 50
    )
    stamps = [m.stamp_ns for m in measurements]
    assert stamps == sorted(stamps)


def test_ground_truth(tmp_path: Path) -> None:
    truth = open_recording(write_bag(tmp_path / "dive")).ground_truth()
    assert truth is not None
    assert truth.stamps_ns.dtype == np.int64 and truth.poses.shape == (50, 6)
    np.testing.assert_allclose(truth.poses[10], [1.0, 0.0, -2.0, 0.0, 0.0, 0.1], atol=1e-12)
    without = write_bag(tmp_path / "other", pings(range(3)))
    assert open_recording(without).ground_truth() is None


def test_depth_follows_the_configuration(tmp_path: Path) -> None:
    path = write_bag(tmp_path / "dive")

    def first_depth(**changes: Any) -> float:
        return next(m.z for m in read(path, **changes)[0] if isinstance(m, Depth))

    absolute = first_depth()
    assert absolute == pytest.approx(-2.0, abs=1e-4)
    assert first_depth(**{"sensors.water_density": 1025.0}) == pytest.approx(absolute / 1.025)
    assert first_depth(**{"sensors.gauge_pressure": True}) == pytest.approx(
        absolute - 10.3323, abs=1e-4
    )


def test_messages_come_in_log_order_across_chunks_and_files(tmp_path: Path) -> None:
    late = pings(range(0, 40, 2))
    early = [(topic, message, log_ns - 10**9) for topic, message, log_ns in pings(range(1, 41, 2))]
    folder = tmp_path / "dive"
    folder.mkdir()
    write_bag(folder / "dive_10.mcap", late[10:])
    write_bag(folder / "dive_2.mcap", late[:10] + early)
    recording = open_recording(folder)
    times = [message.log_ns for message in recording.messages()]
    assert times == sorted(log_ns for _, _, log_ns in late + early)
    assert recording.topics["/sonar/ping"].count == 40


def test_a_namespace_is_admitted_and_two_are_not(tmp_path: Path) -> None:
    spaced = [("/auv" + topic, message, log) for topic, message, log in sensor_messages(5)]
    assert len(read(write_bag(tmp_path / "one", spaced))[0]) == 20
    plain = [*spaced, *sensor_messages(3)]
    assert len(read(write_bag(tmp_path / "plain", plain))[0]) == 12
    twins = [(f"/{name}{topic}", m, log) for name in "ab" for topic, m, log in sensor_messages(2)]
    with pytest.raises(UserError, match=r"/a/sonar/ping, /b/sonar/ping"):
        read(write_bag(tmp_path / "two", twins))


def test_without_a_sonar_the_topics_found_are_named(tmp_path: Path) -> None:
    others = [entry for entry in sensor_messages(2) if entry[0] != "/sonar/ping"]
    message = r"no topic /sonar/ping or /sonar/raw, only .*/imu/data.*msss convert"
    with pytest.raises(UserError, match=message):
        read(write_bag(tmp_path / "dive", others))


def test_a_sonar_of_another_type_is_an_error(tmp_path: Path) -> None:
    odd = [("/sonar/ping", make("sensor_msgs/msg/Imu"), START_NS)]
    with pytest.raises(UserError, match=r"sensor_msgs/msg/Imu, must be sensor_msgs/msg/LaserScan"):
        read(write_bag(tmp_path / "dive", odd))


def test_another_sensor_of_a_wrong_type_is_refused_whole(tmp_path: Path) -> None:
    odd = [("/imu/data", make("std_msgs/msg/UInt8MultiArray"), START_NS)] * 3
    measurements, refusals = read(write_bag(tmp_path / "dive", [*odd, *pings(range(4))]))
    assert (len(measurements), refusals) == (4, {"imu_data_wrong_type": 3})


def test_stamps_that_repeat_or_go_back_are_counted_by_topic(tmp_path: Path) -> None:
    path = write_bag(tmp_path / "dive", pings([0, 1, 1, 2, 0, 3]))
    measurements, refusals = read(path)
    stamps = [m.stamp_ns for m in measurements]
    assert stamps == [START_NS + index * BEAM_PERIOD_NS for index in range(4)]
    assert refusals == {"stamp_not_increasing": 2}


def test_a_refused_message_leaves_no_stamp_behind(tmp_path: Path) -> None:
    empty = beam_message(9)
    empty.ranges = empty.intensities = np.zeros(0, np.float32)
    messages = [("/sonar/ping", empty, START_NS), *pings(range(3))]
    measurements, refusals = read(write_bag(tmp_path / "dive", messages))
    assert (len(measurements), refusals) == (3, {"beam_without_bins": 1})


def test_the_mounting_is_read_from_static_transforms(tmp_path: Path) -> None:
    mounting = Mounting(0.2, -0.1, 0.5)
    static = [("/tf_static", mounting.transforms(START_NS), START_NS)]
    found = open_recording(write_bag(tmp_path / "dive", [*static, *pings(range(2))])).mounting()
    assert found is not None
    assert found.parameters == pytest.approx(mounting.parameters)
    assert open_recording(write_bag(tmp_path / "bare", pings(range(2)))).mounting() is None


def test_the_mounting_completes_the_configuration(tmp_path: Path) -> None:
    static = [("/tf_static", Mounting(0.2, -0.1, 0.5).transforms(START_NS), START_NS)]
    recording = open_recording(write_bag(tmp_path / "dive", [*static, *pings(range(2))]))
    chosen = Configuration().with_values({"sonar.mount_x": 0.7, "mapping.resolution": 0.2})
    completed = recording.completed(chosen)
    sonar = completed.sonar
    assert (sonar.mount_x, sonar.mount_y, sonar.mount_yaw) == pytest.approx((0.7, -0.1, 0.5))
    assert completed.mapping == chosen.mapping


def test_a_bag_without_a_mounting_leaves_the_configuration_as_it_is(tmp_path: Path) -> None:
    chosen = Configuration().with_values({"sonar.mount_x": 0.7})
    bare = open_recording(write_bag(tmp_path / "bare", pings(range(2))))
    assert bare.completed(chosen) == chosen


@pytest.mark.parametrize(
    ("name", "content", "expected"),
    [
        ("nothing", None, "no such file or folder"),
        ("empty.mcap", b"", "the file is empty"),
        ("notes.mcap", b"These are notes of a dive.\n" * 50, "not an mcap recording"),
        ("short.mcap", b"\x89MCAP0\r\n", "not an mcap recording"),
        ("one.bag", b"#ROSBAG V2.0\nrest", "msss convert"),
        ("two.db3", b"SQLite format 3\x00" + bytes(100), "ros2 bag convert"),
    ],
)
def test_what_is_no_recording(tmp_path: Path, name: str, content: Any, expected: str) -> None:
    path = tmp_path / name
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(UserError, match=expected) as caught:
        open_recording(path)
    assert str(path) in str(caught.value) and "\n" not in str(caught.value)


def test_a_bag_without_messages_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="holds no message"):
        open_recording(write_bag(tmp_path / "dive.mcap", []))


def test_folders(tmp_path: Path) -> None:
    (tmp_path / "empty").mkdir()
    with pytest.raises(UserError, match="no recording in this folder"):
        open_recording(tmp_path / "empty")
    (tmp_path / "sqlite").mkdir()
    (tmp_path / "sqlite" / "a.db3").touch()
    with pytest.raises(UserError, match="ros2 bag convert"):
        open_recording(tmp_path / "sqlite")


@pytest.mark.parametrize(
    "metadata", [None, "", "a: [", "just text", "rosbag2_bagfile_information: 3"]
)
def test_metadata_may_be_missing_or_broken(tmp_path: Path, metadata: str | None) -> None:
    bag = write_bag(tmp_path / "dive")
    (bag / "metadata.yaml").unlink()
    if metadata is not None:
        (bag / "metadata.yaml").write_text(metadata)
    assert open_recording(bag).topics["/sonar/ping"].count == 50


def test_a_file_that_metadata_names_and_is_not_there(tmp_path: Path) -> None:
    bag = write_bag(tmp_path / "dive")
    (bag / "dive.mcap").rename(bag / "other.mcap")
    with pytest.raises(UserError, match=r"dive\.mcap, which is not there"):
        open_recording(bag)


def test_a_file_that_must_not_be_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = write_bag(tmp_path / "dive.mcap")

    def deny(*_: Any, **__: Any) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "open", deny)
    with pytest.raises(UserError, match="Permission denied"):
        open_recording(path)
