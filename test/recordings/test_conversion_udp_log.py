# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""A log of UDP datagrams with a head's bytes and ``$ROV`` lines: written here, and a real one."""

from collections import Counter
from collections.abc import Iterator
from datetime import UTC, datetime
from functools import reduce
from math import degrees, pi, radians
from operator import xor
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.recipes import ESTIMATORS
from msss_graphslam.core.types import Beam, Depth, Inertial
from msss_graphslam.errors import UserError
from msss_graphslam.evaluation.errors import position_errors
from msss_graphslam.micron.packets import HeadControl, HeadData, HeadStatus
from msss_graphslam.offline.estimation import estimate
from msss_graphslam.recordings.conversion import ConversionReport, convert
from msss_graphslam.recordings.inspection import inspect
from msss_graphslam.recordings.reader import open_recording
from msss_graphslam.recordings.typestore import decode
from msss_graphslam.simulation.recording import SimulatedBag

DATA = Path(__file__).parents[3] / "shared/data/pysonar_seanet"
REAL = DATA / "UdpHubLog_4001_2017_11_02_09_00_03.csv"
START_NS = 1_500_000_000_000_000_000
MILLISECOND = 1_000_000
SONAR, ROV = "10.3.0.40;4002", "10.3.0.40;13102"


def packet(raw: int, codes: bytes, interval: int = 100) -> bytes:
    head = HeadData(
        device_type=0x11,
        status=HeadStatus.EIGHT_BIT_DATA,
        sweep=0,
        control=HeadControl.EIGHT_BIT | HeadControl.SCAN_RIGHT | HeadControl.HAS_MOTOR,
        range_scale=100,
        transmit=0,
        gain=58,
        slope=0,
        ad_span=81,
        ad_low=8,
        heading_offset=0,
        ad_interval=interval,
        left_limit=0,
        right_limit=6399,
        step=32,
        bearing=raw,
        data=codes,
    )
    return head.frame().encode()


def line(at_ns: int, sender: str, data: bytes) -> str:
    moment = datetime.fromtimestamp(at_ns // 10**9, UTC)
    time = f"{moment:%Y.%m.%d %H.%M.%S}.{at_ns // MILLISECOND % 1000:03d}"
    return f"{time};{sender};{data.hex(' ').upper()}\n"


def sentence(heading: float, roll: float, pitch: float, depth: float) -> bytes:
    return f"$ROV,{heading},{roll},{pitch},{depth},0.0,61.5,2.2,*\r\n".encode()


def pings(count: int, size: int = 20) -> Iterator[str]:
    """Beams every 43 ms, their bytes in datagrams of ``size`` a millisecond apart."""
    for index in range(count):
        data = packet(32 * index % 6400, bytes([index % 250, 7, 9] * 10))
        end_ns = START_NS + (index + 1) * 43 * MILLISECOND
        pieces = [data[i : i + size] for i in range(0, len(data), size)]
        for number, piece in enumerate(pieces):
            yield line(end_ns - (len(pieces) - 1 - number) * MILLISECOND, SONAR, piece)


def converted(folder: Path, text: str) -> tuple[ConversionReport, list[Any]]:
    source = folder / "log.csv"
    source.write_text(text)
    (folder / "out.mcap").unlink(missing_ok=True)
    report = convert(source, folder / "out.mcap")
    refusals: Counter[str] = Counter()
    found = list(open_recording(folder / "out.mcap").measurements(refusals, Configuration()))
    assert not refusals
    return report, found


@pytest.mark.parametrize("size", [1, 20, 1000])
def test_bytes_become_beams_however_they_were_cut(tmp_path: Path, size: int) -> None:
    report, found = converted(tmp_path, "".join(pings(10, size)))
    assert (report.format, report.messages, report.refused) == ("udp_log", {"/sonar/ping": 10}, {})
    np.testing.assert_array_equal(found[3].intensities, [3, 7, 9] * 10)
    length = 100 * 640e-9 * 1500 / 2
    np.testing.assert_allclose(found[0].ranges, (np.arange(30) + 0.5) * length, rtol=1e-6)
    for index, one in enumerate(found):
        expected = np.exp(1j * (pi - radians(1.8) * index))
        assert np.exp(1j * one.bearing) == pytest.approx(expected, abs=1e-6)
        late_ns = START_NS + (index + 1) * 43 * MILLISECOND - one.stamp_ns
        assert 5 * MILLISECOND < late_ns < 30 * MILLISECOND


@pytest.mark.parametrize(
    ("state", "angles"),
    [
        ((90.0, 0.0, 0.0, 1.0), (0, 0, 0)),
        ((0.0, 0.0, 0.0, 1.0), (0, 0, 90)),
        ((180.0, 5.0, 10.0, 1.0), (5, -10, -90)),
        ((359.9, -5.0, -10.0, 341.6), (-5, 10, 90.1)),
    ],
)
def test_the_vehicle_state_comes_back(tmp_path: Path, state: Any, angles: Any) -> None:
    text = "".join(pings(1)) + line(START_NS + 10**9, ROV, sentence(*state))
    report, found = converted(tmp_path, text)
    assert report.messages == {"/sonar/ping": 1, "/imu/data": 1, "/pressure": 1}
    [attitude] = [entry for entry in found if isinstance(entry, Inertial)]
    np.testing.assert_allclose(np.degrees(attitude.orientation), angles, atol=1e-9)
    assert attitude.angular_velocity is None and attitude.stamp_ns == START_NS + 10**9
    [height] = [entry for entry in found if isinstance(entry, Depth)]
    assert height.z == pytest.approx(-state[3])


def test_what_is_not_known_is_marked_so(tmp_path: Path) -> None:
    converted(tmp_path, "".join(pings(1)) + line(START_NS, ROV, sentence(10, 0, 0, 5)))
    messages = {
        raw.channel.topic: decode(raw.data, raw.schema.name)
        for raw in open_recording(tmp_path / "out.mcap").messages()
        if raw.schema is not None
    }
    assert not messages["/imu/data"].orientation_covariance.any()
    assert messages["/imu/data"].angular_velocity_covariance[0] == -1.0
    assert messages["/imu/data"].linear_acceleration_covariance[0] == -1.0
    assert messages["/pressure"].variance == 0.0


def with_checksum(body: bytes, change: int = 0) -> bytes:
    return body + b"*%02X\r\n" % (reduce(xor, body[1:]) ^ change)


@pytest.mark.parametrize(
    ("data", "reason"),
    [
        (b"$ROV,1,2\r\n", "rov_unreadable"),
        (b"$ROV,a,b,c,d,*\r\n", "rov_unreadable"),
        (sentence(float("nan"), 0, 0, 5), "rov_out_of_range"),
        (sentence(0, 0, 0, float("inf")), "rov_out_of_range"),
        (sentence(360.1, 0, 0, 5), "rov_out_of_range"),
        (sentence(0, 0, 90.1, 5), "rov_out_of_range"),
        (sentence(0, 0, 0, -11), "rov_out_of_range"),
        (with_checksum(b"$ROV,1,2,3,4", change=1), "rov_checksum_wrong"),
        (b"$ROV,1,2,3,4*GG\r\n", "rov_checksum_wrong"),
        (with_checksum(b"$ROV,1,2,3,4"), None),
    ],
)
def test_sentences_that_are_refused(tmp_path: Path, data: bytes, reason: str | None) -> None:
    report, found = converted(tmp_path, "".join(pings(1)) + line(START_NS, ROV, data))
    assert report.refused == ({} if reason is None else {reason: 1})
    assert len(found) == (3 if reason is None else 1)


@pytest.mark.parametrize(
    "broken",
    [
        "hello\n",
        "2017.11.02 08.58.46.723;10.3.0.40;4002;0F 1\n",
        "2017.11.02 08.58.46.723;10.3.0.40;4002;\n",
        "2017.13.02 08.58.46.723;10.3.0.40;4002;0F\n",
        "2017.11.02 25.58.46.723;10.3.0.40;4002;0F\n",
        "2017.11.02 08.58.46.723;10.3.0.40;port;0F\n",
        "\x00\xff" * 40 + "\n",
    ],
)
def test_lines_that_are_refused(tmp_path: Path, broken: str) -> None:
    report, found = converted(tmp_path, "".join(pings(3)) + broken + "\n")
    assert report.refused == {"line_unreadable": 1} and len(found) == 3


def test_the_bytes_of_two_heads_are_kept_apart(tmp_path: Path) -> None:
    """Line by line in turn: as one stream not a packet of theirs would be whole."""
    other = [text.replace(";4002;", ";4003;") for text in pings(3)]
    mixed = [text for pair in zip(pings(3), other, strict=True) for text in pair]
    report, found = converted(tmp_path, "".join(mixed))
    assert report.messages == {"/sonar/ping": 3} and len(found) == 3
    assert report.refused == {"beam_of_another_head": 3}


def test_lost_datagrams_cost_their_beams_and_are_counted(tmp_path: Path) -> None:
    lines = list(pings(10))
    del lines[len(lines) // 2]
    report, found = converted(tmp_path, "".join(lines))
    assert len(found) == 9 and sum(report.refused.values()) >= 1


def test_a_clock_that_is_set_back_loses_nothing(tmp_path: Path) -> None:
    lines = list(pings(20))
    later = [text.replace(" 02.40.", " 01.40.") for text in lines[len(lines) // 2 :]]
    assert later != lines[len(lines) // 2 :]
    report, found = converted(tmp_path, "".join(lines[: len(lines) // 2] + later))
    assert report.refused == {"clock_set_back": 1} and len(found) == 20


def test_cut_files_lose_what_was_cut(tmp_path: Path) -> None:
    text = "".join(pings(4))
    lengths = [len(part) for part in text.splitlines(keepends=True)]
    a_beam = sum(lengths) // 4
    for length in range(0, len(text), 23):
        source = tmp_path / "log.csv"
        source.write_text(text[:length])
        (tmp_path / "out.mcap").unlink(missing_ok=True)
        try:
            report = convert(source, tmp_path / "out.mcap")
        except UserError as error:
            assert length < a_beam and "\n" not in str(error)
        else:
            assert report.messages["/sonar/ping"] >= length // a_beam


def test_flipped_bytes_lose_little_and_count_it(tmp_path: Path) -> None:
    text = "".join(pings(5, size=40)).encode()
    source = tmp_path / "log.csv"
    for position in range(0, len(text), 7):
        data = bytearray(text)
        data[position] ^= 0x15
        source.write_bytes(data)
        (tmp_path / "out.mcap").unlink(missing_ok=True)
        report = convert(source, tmp_path / "out.mcap")
        refusals = Counter(report.refused)
        found = list(open_recording(tmp_path / "out.mcap").measurements(refusals, Configuration()))
        assert len(found) >= 3, position
        assert len(found) == 5 or sum(refusals.values()) > 0, position


def test_a_real_log(tmp_path: Path) -> None:
    if not REAL.is_file():
        pytest.skip(f"{REAL} is not here: real recordings are not part of the project")
    report = convert(REAL, tmp_path / "out")
    assert report.messages == {"/sonar/ping": 765, "/imu/data": 588, "/pressure": 588}
    assert report.refused == {"noise": 1}  # it begins in the middle of a packet
    sonar = inspect(tmp_path / "out").sonar
    assert sonar is not None
    assert (sonar.beams, sonar.bins, sonar.settings_changes) == (765, 794, 0)
    assert sonar.maximum_range == pytest.approx(50.69, abs=0.05)
    found = list(open_recording(tmp_path / "out").measurements(Counter(), Configuration()))
    bearings = np.array([entry.bearing for entry in found if isinstance(entry, Beam)])
    assert degrees(bearings.max()) == pytest.approx(80, abs=1)
    assert degrees(bearings.min()) == pytest.approx(-80, abs=1)
    yaws = [entry.orientation[2] for entry in found if isinstance(entry, Inertial)]
    assert np.degrees(yaws) == pytest.approx(90 - 72.35, abs=0.06)
    heights = [entry.z for entry in found if isinstance(entry, Depth)]
    assert np.median(heights) == pytest.approx(-341.6, abs=0.05)
    periods = np.diff([entry.stamp_ns for entry in found if isinstance(entry, Beam)]) * 1e-6
    assert np.median(periods) == pytest.approx(78, abs=1) and periods.min() > 60


def as_udp_log(bag: Path) -> str:
    """The measurements of a bag as the sender's line and vehicle would give them."""
    lines: list[tuple[int, str]] = []
    depth = 0.0
    for entry in open_recording(bag).measurements(Counter(), Configuration()):
        if isinstance(entry, Beam):
            raw = round((pi - entry.bearing) * 3200 / pi) % 6400
            interval = round(2 * float(entry.ranges[0]) * 2 / 1500 / 640e-9)
            data = packet(raw, bytes(entry.intensities.astype(np.uint8).tolist()), interval)
            at_ns = entry.stamp_ns + 31 * MILLISECOND
            lines.append((at_ns, line(at_ns, SONAR, data)))
        elif isinstance(entry, Depth):
            depth = -entry.z
        elif isinstance(entry, Inertial):
            roll, pitch, yaw = np.degrees(entry.orientation)
            data = sentence((90 - yaw) % 360, roll, -pitch, depth)
            lines.append((entry.stamp_ns, line(entry.stamp_ns, ROV, data)))
    return "".join(text for _, text in sorted(lines))


@pytest.mark.slow
def test_a_converted_mission_is_estimated(tmp_path: Path, tank: SimulatedBag) -> None:
    report, _ = converted(tmp_path, as_udp_log(tank.bag))
    assert report.refused == {}
    recording = open_recording(tmp_path / "out.mcap")
    record = estimate(recording, ESTIMATORS["full"], Configuration(), lambda _share, _what: None)
    truth = open_recording(tank.bag).ground_truth()
    assert truth is not None
    assert position_errors(record.estimate.trajectory, truth).anchored.max() < 0.5
