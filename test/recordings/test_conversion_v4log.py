# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Seanet's .V4LOG: files written here by the layout that the real one has, and the real one."""

import struct
from collections import Counter
from datetime import UTC, datetime
from math import inf, nan, pi, radians
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.recipes import ESTIMATORS
from msss_graphslam.core.types import Beam
from msss_graphslam.errors import UserError
from msss_graphslam.offline.estimation import estimate
from msss_graphslam.recordings.conversion import ConversionReport, convert
from msss_graphslam.recordings.inspection import inspect
from msss_graphslam.recordings.mounting import Mounting
from msss_graphslam.recordings.reader import open_recording
from msss_graphslam.simulation.recording import SimulatedBag

REAL = (
    Path(__file__).parents[3] / "shared/data/pysonar_seanet/90degree scan target moving in.V4LOG"
)
MAGIC = b"SeaNetV4 Log File V1           \x1a"
FIRST = 0x100
EPOCH = datetime(1899, 12, 30, tzinfo=UTC)
START = datetime(2026, 5, 4, 12, 0, 0, tzinfo=UTC)
START_NS = int(START.timestamp()) * 10**9
PERIOD_NS = 42_700_000
HEAD_DATA, VERSION_DATA = 2, 1


def days(stamp_ns: int) -> float:
    return (START - EPOCH).total_seconds() / 86400 + (stamp_ns - START_NS) / 86_400e9


def beam(bearing: int, codes: bytes, interval: int = 100, status: int = 0x10) -> bytes:
    """The payload of mtHeadData; the layout is spelled out here once more, as an oracle."""
    control, step = 0x2305, 32
    fields = struct.pack(
        "<BBBHHIBHBBHHHHBHH",
        *(0x11, status, 0, control, 100, 0, 58, 0, 81, 8, 0),
        *(interval, 0, 6399, step, bearing, len(codes)),
    )
    return struct.pack("<H", len(fields) + 2 + len(codes)) + fields + codes


def record(time: float, payload: bytes, kind: int = HEAD_DATA, node: int = 2) -> bytes:
    packet = bytes([node, 0xFF, kind, 0x80, node]) + payload
    return struct.pack("<Hd", len(packet) + 10, time) + packet


def log(records: list[bytes], trailing: list[bytes] | None = None) -> bytes:
    """A whole file: header, settings, pings, what was asked at the start, index."""
    starts = np.cumsum([FIRST, *map(len, records)]).tolist()
    others = b"".join(trailing or [])
    index = starts[-1] + len(others)
    end = index + 4 * len(records)
    table = (0x10, 0x50, FIRST, len(records), starts[-1], index, index, end)
    head = MAGIC + struct.pack("<8I", *table)
    packed = struct.pack(f"<{len(records)}I", *starts[:-1])
    return head.ljust(FIRST, b"r") + b"".join(records) + others + packed + b"\0"


def sweep(count: int, first_ns: int = START_NS) -> list[bytes]:
    return [
        record(days(first_ns + i * PERIOD_NS), beam(32 * i % 6400, bytes([i % 250, 7, 9])))
        for i in range(count)
    ]


def converted(folder: Path, data: bytes, **mounting: Any) -> tuple[ConversionReport, list[Beam]]:
    source = folder / "dive.V4LOG"
    source.write_bytes(data)
    (folder / "out.mcap").unlink(missing_ok=True)
    given = Mounting(**mounting) if mounting else None
    report = convert(source, folder / "out.mcap", given)
    refusals: Counter[str] = Counter()
    found = list(open_recording(folder / "out.mcap").measurements(refusals, Configuration()))
    assert not refusals
    return report, [entry for entry in found if isinstance(entry, Beam)]


def test_pings_become_beams(tmp_path: Path) -> None:
    version = record(days(START_NS) - 0.02, b"\x31\x11" + bytes(9), VERSION_DATA)
    report, found = converted(tmp_path, log(sweep(20), [version]))
    assert (report.format, report.messages, report.refused) == ("v4log", {"/sonar/ping": 20}, {})
    np.testing.assert_array_equal([one.intensities for one in found][3], [3, 7, 9])
    length = 100 * 640e-9 * 1500 / 2
    np.testing.assert_allclose(found[0].ranges, (np.arange(3) + 0.5) * length, rtol=1e-6)
    steps = np.diff(np.unwrap([one.bearing for one in found]))
    np.testing.assert_allclose(steps, -radians(1.8), atol=1e-6)


@pytest.mark.parametrize(
    ("raw", "bearing"), [(3200, 0.0), (1600, pi / 2), (4800, -pi / 2), (0, pi), (6399, -pi)]
)
def test_bearings_are_clockwise_from_astern(tmp_path: Path, raw: int, bearing: float) -> None:
    for inverted, sense in ((False, 1.0), (True, -1.0)):
        data = log([record(days(START_NS), beam(raw, b"\1\2"))])
        _, [one] = converted(tmp_path, data, inverted=inverted)
        expected = np.exp(1j * sense * bearing)
        assert np.exp(1j * one.bearing) == pytest.approx(expected, abs=2e-3)


def test_stamps_are_evened_out_and_lie_before_their_receipt(tmp_path: Path) -> None:
    """Windows counts in ticks of 15.6 ms: a stamp is late by up to that, or comes twice."""
    tick = 15_625_000
    received = [-(-(START_NS + i * PERIOD_NS) // tick) * tick for i in range(100)]
    received[50] = received[51]
    pings = [record(days(at), beam(32 * i % 6400, b"\1\2")) for i, at in enumerate(received)]
    report, found = converted(tmp_path, log(pings))
    assert report.refused == {} and len(found) == 100
    stamps = np.array([one.stamp_ns for one in found])
    assert (stamps < received).all() and (np.diff(stamps) > 0).all()
    assert np.abs(np.diff(stamps[20:]) - PERIOD_NS).max() < 8_000_000


def test_a_clock_that_is_set_back_loses_no_beam(tmp_path: Path) -> None:
    pings = sweep(10) + sweep(10, START_NS - 3_600_000_000_000)
    report, found = converted(tmp_path, log(pings))
    assert report.refused == {"clock_set_back": 1} and len(found) == 20
    stamps = np.array([one.stamp_ns for one in found])
    np.testing.assert_allclose(np.diff(stamps), PERIOD_NS, atol=1e6)


def test_a_pause_stays_a_pause(tmp_path: Path) -> None:
    report, found = converted(tmp_path, log(sweep(10) + sweep(10, START_NS + 30 * 10**9)))
    assert report.refused == {} and len(found) == 20
    pause_ns = 30 * 10**9 - 9 * PERIOD_NS
    assert found[10].stamp_ns - found[9].stamp_ns == pytest.approx(pause_ns, abs=1e6)


@pytest.mark.parametrize(
    ("broken", "reason"),
    [
        (record(nan, beam(32, b"\1\2")), "record_stamp_invalid"),
        (record(inf, beam(32, b"\1\2")), "record_stamp_invalid"),
        (record(1e5, beam(32, b"\1\2")), "record_stamp_invalid"),
        (record(25568.9, beam(32, b"\1\2")), "record_stamp_invalid"),
        (record(days(START_NS), beam(6400, b"\1\2")), "head_data_the_bearing_is_beyond_a_turn"),
        (record(days(START_NS), b"\1"), "record_unreadable"),
        (record(days(START_NS), beam(32, b"")), "head_data_no_bins"),
        (record(days(START_NS), beam(32, b"\1\2", interval=0)), "head_data_without_bins"),
        (record(days(START_NS), beam(32, b"\1", status=2)), "head_has_lost_its_bearing"),
        (record(days(START_NS), beam(32, b"\1\2"), node=3), "beam_of_another_head"),
    ],
)
def test_records_that_are_refused(tmp_path: Path, broken: bytes, reason: str) -> None:
    pings = sweep(6)
    report, found = converted(tmp_path, log([*pings[:3], broken, *pings[3:]]))
    assert report.refused == {reason: 1} and len(found) == 6


@pytest.mark.parametrize("size", [0, 9, 0xFFFF])
def test_a_record_of_a_wrong_size_costs_one_beam_with_an_index(tmp_path: Path, size: int) -> None:
    pings = sweep(6)
    pings[2] = struct.pack("<H", size) + pings[2][2:]
    report, found = converted(tmp_path, log(pings))
    assert report.refused == {"record_unreadable": 1} and len(found) == 5
    whole = log(pings)
    report, found = converted(tmp_path, whole[: -4 * len(pings)])
    assert report.refused == {"record_unreadable": 4} and len(found) == 2


def test_an_index_that_lies_is_not_followed(tmp_path: Path) -> None:
    data = bytearray(log(sweep(6)))
    data[-5] ^= 0xFF
    report, found = converted(tmp_path, bytes(data))
    assert report.refused == {} and len(found) == 6


def test_cut_files_count_what_is_missing(tmp_path: Path) -> None:
    pings = sweep(6)
    whole = log(pings)
    end = len(whole) - 4 * len(pings) - 1
    size = len(pings[0])
    for length in range(0, end, 3):
        complete = max(length - FIRST, 0) // size
        if complete == 0:
            with pytest.raises(UserError) as caught:
                converted(tmp_path, whole[:length])
            assert "\n" not in str(caught.value)
        else:
            report, found = converted(tmp_path, whole[:length])
            assert len(found) == complete
            assert report.refused == {"record_unreadable": 6 - complete}


def test_flipped_bytes_lose_little_and_count_it(tmp_path: Path) -> None:
    """The first stamp cannot be checked: then the next two seem to jump ahead."""
    whole = log(sweep(6))
    source = tmp_path / "dive.V4LOG"
    for position in range(len(MAGIC) + 8, len(whole)):
        data = bytearray(whole)
        data[position] ^= 0xFF
        source.write_bytes(data)
        (tmp_path / "out.mcap").unlink(missing_ok=True)
        if position < 0x2C:
            with pytest.raises(UserError, match=r"damaged|no usable beam"):
                convert(source, tmp_path / "out.mcap")
            continue
        refusals = Counter(convert(source, tmp_path / "out.mcap").refused)
        found = list(open_recording(tmp_path / "out.mcap").measurements(refusals, Configuration()))
        least = 4 if FIRST + 2 <= position < FIRST + 10 else 5
        assert least <= len(found) <= 6, position
        assert position < FIRST or len(found) == 6 or sum(refusals.values()) > 0, position


def test_a_real_log(tmp_path: Path) -> None:
    if not REAL.is_file():
        pytest.skip(f"{REAL} is not here: real recordings are not part of the project")
    report = convert(REAL, tmp_path / "out")
    assert (report.messages, report.refused) == ({"/sonar/ping": 468}, {})
    sonar = inspect(tmp_path / "out").sonar
    assert sonar is not None
    assert (sonar.beams, sonar.bins, sonar.settings_changes) == (468, 642, 0)
    assert sonar.step == pytest.approx(radians(3.6), rel=1e-3)
    found = [
        entry
        for entry in open_recording(tmp_path / "out").measurements(Counter(), Configuration())
        if isinstance(entry, Beam)
    ]
    bearings = np.array([one.bearing for one in found])
    assert bearings.max() == pytest.approx(radians(46.8)) and bearings.min() < radians(-36)
    assert found[0].ranges[-1] == pytest.approx(10.17, abs=0.02)
    periods = np.diff([one.stamp_ns for one in found])[1:] * 1e-6
    assert (periods > 60).all() and (periods < 130).all()


def as_v4log(beams: list[Beam]) -> bytes:
    """Beams as a head would send them, quantised, and recorded when they arrive."""
    pings = []
    for one in beams:
        raw = round((pi - one.bearing) * 3200 / pi) % 6400
        interval = round(2 * float(one.ranges[0]) * 2 / 1500 / 640e-9)
        codes = bytes(one.intensities.astype(np.uint8).tolist())
        pings.append(record(days(one.stamp_ns + 31_000_000), beam(raw, codes, interval)))
    return log(pings)


@pytest.mark.slow
def test_a_converted_mission_runs(tmp_path: Path, tank: SimulatedBag) -> None:
    entries = open_recording(tank.bag).measurements(Counter(), Configuration())
    sent = [entry for entry in entries if isinstance(entry, Beam)]
    report, found = converted(tmp_path, as_v4log(sent))
    assert report.refused == {} and len(found) == len(sent)
    for one, other in zip(found, sent, strict=True):
        assert np.exp(1j * one.bearing) == pytest.approx(np.exp(1j * other.bearing), abs=1e-3)
        np.testing.assert_allclose(one.ranges, other.ranges, rtol=5e-3)
        np.testing.assert_array_equal(one.intensities, other.intensities)
        assert abs(one.stamp_ns - other.stamp_ns) < 10_000_000
    recording = open_recording(tmp_path / "out.mcap")
    record = estimate(recording, ESTIMATORS["full"], Configuration(), lambda _share, _what: None)
    assert not record.refused and np.isfinite(record.estimate.trajectory.poses).all()
    assert len(record.estimate.trajectory.poses) == len(sent) and len(record.points) > 100
