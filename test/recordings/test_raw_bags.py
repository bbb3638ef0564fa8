# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Bags that have the bytes of the head's port, with pings beside them or without."""

from collections import Counter
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from head_bytes import PERIOD_NS, START_NS, packet, packets, raw_messages
from sample_bags import sensor_messages, write_bag

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.types import Beam
from msss_graphslam.errors import UserError
from msss_graphslam.messages import encoding, topics
from msss_graphslam.recordings.inspection import inspect
from msss_graphslam.recordings.reader import open_recording
from msss_graphslam.recordings.typestore import TYPES, make

Pieces = Iterable[tuple[bytes, int]]


def beams_of(path: Path, **changes: Any) -> tuple[list[Beam], Counter[str]]:
    refusals: Counter[str] = Counter()
    configuration = Configuration().with_values(changes)
    read = open_recording(path).measurements(refusals, configuration)
    return [measurement for measurement in read if isinstance(measurement, Beam)], refusals


def raw_bag(path: Path, pieces: Pieces, *, labelled: bool = True) -> Path:
    return write_bag(path, raw_messages(pieces, labelled=labelled))


def rechunked(pieces: Pieces, size: int) -> list[tuple[bytes, int]]:
    """Return the bytes in pieces of that size, received with the last byte of each."""
    data = [(byte, received_ns) for piece, received_ns in pieces for byte in piece]
    groups = [data[start : start + size] for start in range(0, len(data), size)]
    return [(bytes(byte for byte, _ in group), group[-1][1]) for group in groups]


@pytest.mark.parametrize("labelled", [True, False])
def test_beams_come_out_of_the_bytes(tmp_path: Path, labelled: bool) -> None:
    beams, refusals = beams_of(raw_bag(tmp_path / "raw", packets(), labelled=labelled))
    assert len(beams) == 50
    assert not refusals
    np.testing.assert_allclose(
        [beam.stamp_ns for beam in beams], START_NS + np.arange(50) * PERIOD_NS, atol=1e6, rtol=0
    )
    np.testing.assert_array_equal(beams[7].intensities, np.frombuffer(packet(7).data, np.uint8))
    assert beams[1].bearing == pytest.approx(-np.radians(1.8))
    assert beams[0].ranges[-1] == pytest.approx(39.5 * 521 * 640e-9 * 750.0)


def test_a_label_goes_before_the_log_time(tmp_path: Path) -> None:
    late = [(topic, message, log + 10**9) for topic, message, log in raw_messages(packets())]
    beams, _ = beams_of(write_bag(tmp_path / "raw", late))
    assert beams[0].stamp_ns < START_NS + PERIOD_NS


def test_numbers_are_those_that_a_topic_would_carry(tmp_path: Path) -> None:
    """The nodes see 32 bits of ranges and bearings, so the offline run does, too."""
    beams, _ = beams_of(raw_bag(tmp_path / "raw", packets()))
    for beam in beams:
        assert beam.bearing == float(np.float32(beam.bearing))
        np.testing.assert_array_equal(beam.ranges, beam.ranges.astype(np.float32))


def test_sound_speed_and_mounting_of_the_head_are_heeded(tmp_path: Path) -> None:
    bag = raw_bag(tmp_path / "raw", packets())
    (plain, _), (fast, _) = beams_of(bag), beams_of(bag, **{"micron.sound_speed": 1530.0})
    assert fast[3].ranges[-1] == pytest.approx(1.02 * plain[3].ranges[-1])
    (inverted, _) = beams_of(bag, **{"micron.inverted": True})
    assert inverted[3].bearing == pytest.approx(-plain[3].bearing)


@pytest.mark.parametrize("size", [1, 7, 64, 400])
def test_packets_may_be_cut_anywhere(tmp_path: Path, size: int) -> None:
    bag = raw_bag(tmp_path / "raw", rechunked(packets(20), size))
    beams, refusals = beams_of(bag)
    assert len(beams) == 20
    assert not refusals


def test_damage_is_counted_and_costs_no_other_beam(tmp_path: Path) -> None:
    pieces = list(packets())
    pieces[10] = (b"\x00\xffnoise\n" + pieces[10][0], pieces[10][1])
    pieces[20] = (pieces[20][0][:30], pieces[20][1])
    beams, refusals = beams_of(raw_bag(tmp_path / "raw", pieces))
    assert len(beams) == 49
    assert refusals
    assert all(reason == reason.lower() and " " not in reason for reason in refusals)


def test_a_message_that_is_none_is_refused(tmp_path: Path) -> None:
    messages = list(raw_messages(packets(5)))
    messages[2][1].layout.dim[0].label = "received yesterday"
    beams, refusals = beams_of(write_bag(tmp_path / "raw", messages))
    assert len(beams) == 4
    assert refusals["raw_label_invalid"] == 1


def test_pings_go_before_raw_bytes(tmp_path: Path) -> None:
    messages = [*sensor_messages(), *raw_messages(packets(7))]
    path = write_bag(tmp_path / "both", sorted(messages, key=lambda entry: entry[2]))
    assert open_recording(path).sonar_topic == topics.SONAR_PING
    beams, refusals = beams_of(path)
    assert len(beams) == 50
    assert not refusals


def test_beams_between_two_times_have_the_stamps_of_the_whole_run(tmp_path: Path) -> None:
    path = raw_bag(tmp_path / "raw", packets(200))
    whole = [beam.stamp_ns for beam in beams_of(path)[0]]
    part = [b.stamp_ns for b in open_recording(path).beams(whole[120], whole[125])]
    assert set(whole[120:126]) <= set(part) <= set(whole)


def test_raw_bytes_of_another_type_are_named(tmp_path: Path) -> None:
    scan = encoding.fluid_pressure(make, START_NS, 1e5, "base_link")
    recording = open_recording(write_bag(tmp_path / "raw", [("/sonar/raw", scan, START_NS)]))
    with pytest.raises(UserError, match="/sonar/raw is of type sensor_msgs/msg/FluidPressure"):
        recording.measurements(Counter(), Configuration())


def test_a_bag_without_any_sonar_names_both_topics(tmp_path: Path) -> None:
    messages = [entry for entry in sensor_messages() if "sonar" not in entry[0]]
    recording = open_recording(write_bag(tmp_path / "deaf", messages))
    with pytest.raises(UserError, match="no topic /sonar/ping or /sonar/raw, only /dvl/twist"):
        recording.measurements(Counter(), Configuration())


def test_inspection_reads_the_bytes(tmp_path: Path) -> None:
    report = inspect(raw_bag(tmp_path / "raw", [*packets(), (b"noise", START_NS + 10**10)]))
    assert report.can_run
    assert report.sonar_topic == "/sonar/raw"
    assert report.sonar is not None
    assert (report.sonar.beams, report.sonar.bins, report.sonar.direction) == (50, 40, "clockwise")
    assert report.sonar.beam_period == pytest.approx(PERIOD_NS * 1e-9, rel=0.01)


def test_inspection_says_when_no_beam_is_in_the_bytes(tmp_path: Path) -> None:
    report = inspect(raw_bag(tmp_path / "raw", [(b"@" * 50, START_NS)]))
    assert not report.can_run
    assert "not one beam" in report.problem


def test_the_bytes_of_the_messages_are_those_of_a_bag_of_ros(tmp_path: Path) -> None:
    path = raw_bag(tmp_path / "raw", packets(1))
    (raw,) = open_recording(path).messages()
    message = next(raw_messages(packets(1)))[1]
    assert raw.data == bytes(TYPES.serialize_cdr(message, topics.SONAR_RAW.type_name))
