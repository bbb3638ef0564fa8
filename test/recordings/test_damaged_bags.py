# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Damaged files, made byte by byte: every whole message comes back, and nothing else."""

from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from mcap.writer import CompressionType, Writer
from rosbags.rosbag2 import CompressionMode, StoragePlugin
from rosbags.rosbag2 import Writer as RosbagsWriter
from rosbags.rosbag2.enums import CompressionFormat
from sample_bags import sensor_messages, write_bag

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.errors import UserError
from msss_graphslam.recordings import mcap_writing
from msss_graphslam.recordings.damage import Damage
from msss_graphslam.recordings.reader import open_recording
from msss_graphslam.recordings.salvage import salvage
from msss_graphslam.recordings.typestore import TYPES

Message = tuple[str, int, bytes]


def serialised(beams: int) -> Iterator[Message]:
    for topic, message, log_ns in sensor_messages(beams):
        yield topic, log_ns, bytes(TYPES.serialize_cdr(message, message.__msgtype__))


def content(path: Path) -> list[Message]:
    return [(m.channel.topic, m.log_ns, m.data) for m in open_recording(path).messages()]


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """A bag of 250 messages in about a dozen chunks."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(mcap_writing, "_CHUNK_BYTES", 4096)
        return write_bag(tmp_path_factory.mktemp("whole") / "dive.mcap").read_bytes()


@pytest.fixture(scope="module")
def originals() -> Counter[Message]:
    return Counter(serialised(50))


def check(path: Path, data: bytes, originals: Counter[Message]) -> tuple[int, Damage]:
    """Read the bytes; whatever comes out must be among the originals."""
    path.write_bytes(data)
    try:
        recording = open_recording(path)
    except UserError as error:
        assert "\n" not in str(error)
        return 0, Damage()
    found = Counter((m.channel.topic, m.log_ns, m.data) for m in recording.messages())
    assert found <= originals
    assert found.total() == sum(topic.count for topic in recording.topics.values())
    return found.total(), recording.damage


def test_a_file_cut_off_anywhere(
    tmp_path: Path, whole: bytes, originals: Counter[Message]
) -> None:
    path = tmp_path / "cut.mcap"
    counts = []
    for length in range(0, len(whole), 73):
        count, damage = check(path, whole[:length], originals)
        assert damage.truncated or count == 0
        counts.append(count)
    assert counts == sorted(counts)
    assert len(set(counts)) > 5 and counts[-1] == 250


def test_one_byte_flipped_anywhere(
    tmp_path: Path, whole: bytes, originals: Counter[Message]
) -> None:
    path = tmp_path / "flipped.mcap"
    for position in range(0, len(whole), 97):
        data = bytearray(whole)
        data[position] ^= 0xFF
        count, damage = check(path, bytes(data), originals)
        assert count >= 200
        assert count == 250 or damage.lost_messages == 250 - count


@settings(
    max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(st.lists(st.tuples(st.floats(0.0, 0.999), st.integers(1, 255)), max_size=30))
def test_many_bytes_flipped(
    tmp_path: Path, whole: bytes, originals: Counter[Message], flips: list[tuple[float, int]]
) -> None:
    data = bytearray(whole)
    for place, bits in flips:
        data[int(place * len(data))] ^= bits
    check(tmp_path / "flipped.mcap", bytes(data), originals)


@settings(
    max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(st.binary(max_size=300))
def test_any_bytes_behind_the_magic(tmp_path: Path, tail: bytes) -> None:
    count, _ = check(tmp_path / "any.mcap", b"\x89MCAP0\r\n" + tail, Counter())
    assert count == 0


@pytest.mark.parametrize("hole", [1, 100, 5000])
def test_a_hole_costs_only_what_it_touches(
    tmp_path: Path, whole: bytes, originals: Counter[Message], hole: int
) -> None:
    middle = len(whole) // 2
    data = whole[:middle] + whole[middle + hole :]
    count, damage = check(tmp_path / "hole.mcap", data, originals)
    assert 100 <= count < 250
    assert damage.lost_messages == 250 - count


def variant(path: Path, *, chunked: bool, crc: bool, compression: CompressionType) -> Path:
    """Write the messages as other recorders would."""
    with path.open("wb") as stream:
        writer = Writer(
            stream, 4096, compression, use_chunking=chunked, enable_crcs=crc, enable_data_crcs=crc
        )
        writer.start("ros2")
        channels: dict[str, int] = {}
        for topic, message, log_ns in sensor_messages():
            name = message.__msgtype__
            if topic not in channels:
                schema = writer.register_schema(name, "ros2msg", b"")
                channels[topic] = writer.register_channel(topic, "cdr", schema)
            data = bytes(TYPES.serialize_cdr(message, name))
            writer.add_message(channels[topic], log_ns, data, log_ns)
        writer.finish()
    return path


@pytest.mark.parametrize("chunked", [True, False])
@pytest.mark.parametrize("crc", [True, False])
@pytest.mark.parametrize("compression", list(CompressionType))
def test_files_of_other_recorders(
    tmp_path: Path, originals: Counter[Message], chunked: bool, crc: bool, compression: Any
) -> None:
    path = variant(tmp_path / "other.mcap", chunked=chunked, crc=crc, compression=compression)
    data = path.read_bytes()
    count, damage = check(path, data, originals)
    assert count == 250 and not damage
    cut = [check(path, data[:length], originals)[0] for length in range(0, len(data), 997)]
    assert cut == sorted(cut) and cut[-1] > 100


def test_a_bag_of_the_rosbags_library(tmp_path: Path, originals: Counter[Message]) -> None:
    writer = RosbagsWriter(tmp_path / "dive", version=9, storage_plugin=StoragePlugin.MCAP)
    writer.set_compression(CompressionMode.STORAGE, CompressionFormat.ZSTD)
    with writer as bag:
        connections: dict[str, Any] = {}
        for topic, message, log_ns in sensor_messages():
            name = message.__msgtype__
            if topic not in connections:
                connections[topic] = bag.add_connection(topic, name, typestore=TYPES)
            bag.write(connections[topic], log_ns, TYPES.serialize_cdr(message, name))
    recording = open_recording(tmp_path / "dive")
    assert not recording.damage
    assert Counter(content(tmp_path / "dive")) == originals


def test_metadata_tells_what_a_cut_file_lost(tmp_path: Path, whole: bytes) -> None:
    bag = write_bag(tmp_path / "dive")
    (bag / "dive.mcap").write_bytes(whole[: len(whole) // 2])
    recording = open_recording(bag)
    count = sum(topic.count for topic in recording.topics.values())
    assert 0 < count < 250
    assert recording.damage.lost_messages == 250 - count
    assert f"{250 - count} messages lost, the file ends early" in str(recording.damage)
    (bag / "metadata.yaml").unlink()
    assert open_recording(bag).damage.lost_messages is None
    assert "unknown number" in str(open_recording(bag).damage)


def test_messages_whose_bytes_are_no_message_are_counted(tmp_path: Path) -> None:
    path = tmp_path / "odd.mcap"
    with path.open("wb") as stream:
        writer = Writer(stream)
        writer.start("ros2")
        for topic, kind in (("/sonar/ping", "sensor_msgs/msg/LaserScan"),):
            schema = writer.register_schema(kind, "ros2msg", b"")
            channel = writer.register_channel(topic, "cdr", schema)
        good = [data for topic, _, data in serialised(3) if topic == "/sonar/ping"]
        huge = good[0][:44] + b"\xff\xff\xff\xff" + good[0][48:]
        for index, data in enumerate([*good, b"", b"\x00", good[0][:50], bytes(500), huge]):
            writer.add_message(channel, index, data, index)
        writer.finish()
    refusals: Counter[str] = Counter()
    beams = list(open_recording(path).measurements(refusals, Configuration()))
    assert len(beams) == 3
    assert refusals.total() == 5
    assert refusals["sonar_ping_undecodable"] >= 3


@pytest.mark.parametrize("seed", range(3))
def test_random_bytes_as_messages_never_get_through(tmp_path: Path, seed: int) -> None:
    generator = np.random.default_rng(seed)
    path = tmp_path / "random.mcap"
    with path.open("wb") as stream:
        writer = Writer(stream)
        writer.start("ros2")
        for number, (topic, message, _) in enumerate(sensor_messages(1)):
            schema = writer.register_schema(message.__msgtype__, "ros2msg", b"")
            channel = writer.register_channel(topic, "cdr", schema)
            data = bytearray(TYPES.serialize_cdr(message, message.__msgtype__))
            for index in range(200):
                broken = bytearray(data)
                for place in generator.integers(4, len(data), 12):
                    broken[place] = generator.integers(256)
                writer.add_message(channel, 1000 * number + index, bytes(broken), 0)
        writer.finish()
    refusals: Counter[str] = Counter()
    for measurement in open_recording(path).measurements(refusals, Configuration()):
        values = [getattr(measurement, name) for name in measurement.__slots__]
        assert all(np.isfinite(value).all() for value in values if value is not None)
    assert refusals.total() > 100


def test_salvage_saves_every_whole_message(tmp_path: Path, whole: bytes) -> None:
    damaged = tmp_path / "damaged.mcap"
    data = bytearray(whole[: len(whole) * 4 // 5])
    data[len(data) // 3] ^= 0x10
    damaged.write_bytes(data)
    report = salvage(damaged, tmp_path / "saved")
    assert content(tmp_path / "saved") == content(damaged)
    assert not open_recording(tmp_path / "saved").damage
    assert sum(report.messages.values()) == len(content(damaged)) > 100
    assert report.damage.truncated and report.damage.broken_chunks == 1


def test_salvage_keeps_what_is_written_about_a_topic(tmp_path: Path) -> None:
    source = write_bag(tmp_path / "dive")
    salvage(source, tmp_path / "saved")
    before, after = (
        (folder / "metadata.yaml").read_text().replace(folder.name, "")
        for folder in (source, tmp_path / "saved")
    )
    assert before == after


def test_salvage_overwrites_nothing_and_needs_something(tmp_path: Path, whole: bytes) -> None:
    source = tmp_path / "dive.mcap"
    source.write_bytes(whole)
    with pytest.raises(UserError, match="exists already"):
        salvage(source, source)
    assert source.read_bytes() == whole
    source.write_bytes(whole[:100])
    with pytest.raises(UserError):
        salvage(source, tmp_path / "saved")
    assert not (tmp_path / "saved").exists()
