# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Bags as written: readable by others, whole or not there, the same bytes every time."""

from pathlib import Path

import pytest
import yaml
from mcap.reader import make_reader
from mcap.writer import Writer
from rosbags.highlevel import AnyReader
from sample_bags import START_NS, sensor_messages, write_bag

from msss_graphslam.errors import UserError
from msss_graphslam.recordings.typestore import TYPES, make
from msss_graphslam.recordings.writer import BagWriter


def test_rosbags_reads_every_message_back(tmp_path: Path) -> None:
    written = list(sensor_messages())
    bag = write_bag(tmp_path / "dive")
    with AnyReader([bag]) as reader:
        read = [(c.topic, time, bytes(data)) for c, time, data in reader.messages()]
        latched = {c.topic: c.ext.offered_qos_profiles[0] for c in reader.connections}
    expected = [
        (topic, time, bytes(TYPES.serialize_cdr(message, message.__msgtype__)))
        for topic, message, time in written
    ]
    assert sorted(read) == sorted(expected)
    assert latched["/sonar/ping"].depth > 240


def test_metadata_says_what_is_in_the_bag(tmp_path: Path) -> None:
    bag = write_bag(tmp_path / "dive")
    content = yaml.safe_load((bag / "metadata.yaml").read_text())["rosbag2_bagfile_information"]
    assert content["version"] == 9
    assert content["relative_file_paths"] == ["dive.mcap"]
    assert content["message_count"] == 250
    assert content["starting_time"]["nanoseconds_since_epoch"] == START_NS
    topics = {t["topic_metadata"]["name"]: t for t in content["topics_with_message_count"]}
    ping = topics["/sonar/ping"]
    assert ping["message_count"] == 50
    assert ping["topic_metadata"]["type"] == "sensor_msgs/msg/LaserScan"
    assert ping["topic_metadata"]["type_description_hash"].startswith("RIHS01_")
    assert ping["topic_metadata"]["offered_qos_profiles"][0]["reliability"] == "reliable"


def test_every_chunk_is_compressed_and_has_a_checksum(tmp_path: Path) -> None:
    path = write_bag(tmp_path / "dive.mcap")
    with path.open("rb") as stream:
        reader = make_reader(stream, validate_crcs=True)
        assert reader.get_header().profile == "ros2"
        assert len(list(reader.iter_messages())) == 250
        summary = reader.get_summary()
    assert summary is not None
    assert {chunk.compression for chunk in summary.chunk_indexes} == {"zstd"}
    assert {schema.encoding for schema in summary.schemas.values()} == {"ros2msg"}


def test_the_same_messages_give_the_same_bytes(tmp_path: Path) -> None:
    first, second = write_bag(tmp_path / "a.mcap"), write_bag(tmp_path / "b.mcap")
    assert first.read_bytes() == second.read_bytes()


@pytest.mark.parametrize("name", ["dive", "dive.mcap"])
def test_an_exception_leaves_nothing_behind(tmp_path: Path, name: str) -> None:
    with pytest.raises(RuntimeError), BagWriter(tmp_path / name) as bag:
        bag.write("/pressure", make("sensor_msgs/msg/FluidPressure"), 1)
        raise RuntimeError
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("name", ["dive", "dive.mcap"])
def test_nothing_is_there_before_the_end(tmp_path: Path, name: str) -> None:
    with BagWriter(tmp_path / name) as bag:
        bag.write("/pressure", make("sensor_msgs/msg/FluidPressure"), 1)
        assert not (tmp_path / name).exists()
    assert [entry.name for entry in tmp_path.iterdir()] == [name]


def test_a_folder_is_never_overwritten(tmp_path: Path) -> None:
    bag = write_bag(tmp_path / "dive")
    before = (bag / "dive.mcap").read_bytes()
    with pytest.raises(UserError, match="exists already"):
        write_bag(bag, [])
    assert (bag / "dive.mcap").read_bytes() == before


@pytest.mark.parametrize("name", ["dive", "dive.mcap"])
def test_where_nothing_can_be_written(tmp_path: Path, name: str) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(UserError, match="cannot be written"):
        write_bag(tmp_path / "file" / name)


def test_a_full_disk_leaves_nothing_behind(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(_: Writer) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Writer, "finish", fail)
    for name in ("dive", "dive.mcap"):
        with pytest.raises(OSError, match="No space left"):
            write_bag(tmp_path / name)
    assert list(tmp_path.iterdir()) == []


def test_a_bag_without_messages_is_a_bag(tmp_path: Path) -> None:
    bag = write_bag(tmp_path / "dive", [])
    with AnyReader([bag]) as reader:
        assert reader.message_count == 0


def test_fields_left_out_are_zero() -> None:
    message = make("nav_msgs/msg/Odometry")
    assert message.pose.covariance.shape == (36,)
    assert (message.child_frame_id, message.pose.pose.position.x) == ("", 0.0)
    assert make("visualization_msgs/msg/MarkerArray").markers == []
