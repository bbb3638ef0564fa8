# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""``simulate --raw``: the bytes that a head sends, from which beams are made as at sea."""

from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from simulated_scenes import SETTINGS, SQUARE, basin, resting

from msss_graphslam.cli.main import main
from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.types import Array, Beam
from msss_graphslam.errors import UserError
from msss_graphslam.messages import decoding, topics
from msss_graphslam.micron.framing import Framer
from msss_graphslam.micron.packets import HeadControl, HeadData
from msss_graphslam.micron.raw_log import RawBeams
from msss_graphslam.recordings.reader import open_recording
from msss_graphslam.recordings.typestore import decode
from msss_graphslam.simulation import recording
from msss_graphslam.simulation.echo_model import EchoKind
from msss_graphslam.simulation.raw_output import head_settings, packets
from msss_graphslam.simulation.recording import SimulatedBag, simulate
from msss_graphslam.simulation.settings import Rotation, SonarSettings
from msss_graphslam.simulation.sonar import SonarRecord, scan
from msss_graphslam.simulation.worlds import WORLD_NAMES, World, world_named

LAUNCH_NS = 1_750_000_000_000_000_000
STEP = 2.0 * np.pi / 6400.0


def short_world(name: str = "pond") -> World:
    """The world with a path of 1 m."""
    world = world_named(name)
    path = world.path
    short = replace(
        path,
        points=path.points[:50],
        tangents=path.tangents[:50],
        arc_lengths=path.arc_lengths[:50],
    )
    return replace(world, path=short, laps=1)


def recorded(settings: SonarSettings, seconds: float = 20.0) -> SonarRecord:
    """What a resting vehicle's head records with the settings nearest to these."""
    rounded = head_settings(settings)
    world = basin(SQUARE, rounded)
    return scan(world, resting(seconds), rounded, EchoKind.REAL, 1, lambda _: None)


def decoded(record: SonarRecord) -> list[Beam]:
    beams = RawBeams(1500.0, inverted=False, baudrate=115200)
    return [
        beam
        for time, data in packets(record)
        for beam in beams.feed(data, LAUNCH_NS + round(time * 1e9))
    ]


def turned(angles: Array) -> Array:
    return np.asarray(np.angle(np.exp(1j * angles)))


@pytest.mark.parametrize("name", WORLD_NAMES)
def test_the_beams_of_a_bag_have_their_true_times_and_bearings(name: str, tmp_path: Path) -> None:
    world = short_world(name)
    settings = head_settings(world.sonar)
    bag = simulate(world, 4, tmp_path, raw=True).bag
    refusals: Counter[str] = Counter()
    found = open_recording(bag).measurements(refusals, Configuration())
    beams = [measurement for measurement in found if isinstance(measurement, Beam)]
    assert not refusals
    assert len(beams) > 80
    stamps = np.array([beam.stamp_ns - LAUNCH_NS for beam in beams]) * 1e-9
    true = np.arange(len(beams)) * settings.beam_period
    assert np.abs(stamps - true).max() < 5e-3
    bearings = np.array([beam.bearing for beam in beams])
    sense = -1.0 if settings.rotation is Rotation.CLOCKWISE else 1.0
    expected = bearings[0] + sense * settings.step * np.arange(len(beams))
    np.testing.assert_allclose(turned(bearings - expected), 0.0, atol=1e-6)
    np.testing.assert_allclose(np.mod(bearings / STEP + 0.5, 1.0), 0.5, atol=1e-3)
    np.testing.assert_allclose(beams[0].ranges, settings.ranges, atol=1e-5)


@pytest.mark.parametrize("rotation", Rotation)
def test_bearings_and_codes_come_through_to_the_unit(rotation: Rotation) -> None:
    record = recorded(replace(SETTINGS, rotation=rotation))
    beams = decoded(record)
    assert len(beams) == len(record.times)
    for beam, bearing, codes in zip(beams, record.bearings, record.codes, strict=True):
        assert turned(beam.bearing - bearing) == pytest.approx(0.0, abs=1e-9)
        np.testing.assert_array_equal(beam.intensities, codes)


def test_the_head_sends_what_real_ones_send() -> None:
    record = recorded(replace(SETTINGS, rotation=Rotation.CLOCKWISE))
    frames = [frame for _, data in packets(record) for frame in Framer().feed(data)]
    replies = [HeadData.decode(frame) for frame in frames]
    assert len(replies) == len(record.times)
    assert {(r.device_type, int(r.status), r.sweep, r.step) for r in replies} == {
        (0x11, 16, 0, 32)
    }
    assert {r.range_scale for r in replies} == {100}
    assert {r.ad_interval for r in replies} == {104}
    assert all(HeadControl.CONTINUOUS in r.control for r in replies)
    assert set(np.mod(np.diff([r.bearing for r in replies]), 6400).tolist()) == {32}


@pytest.mark.parametrize(
    ("settings", "bins", "step", "ad_interval"),
    [
        (SonarSettings(10.0, 200, np.radians(1.8), 0.05), 200, 32, 104),
        (SonarSettings(20.0, 350, np.radians(1.8), 0.05), 350, 32, 119),
        (SonarSettings(24.0, 400, np.radians(1.5), 0.05), 400, 27, 125),
        (SonarSettings(50.0, 800, np.radians(1.8), 0.1), 800, 32, 130),
        (SonarSettings(50.0, 801, np.radians(1.8), 0.1), 800, 32, 130),
        (SonarSettings(10.0, 200, 0.1 * STEP, 0.05), 200, 1, 104),
        (SonarSettings(0.01, 800, np.radians(1.8), 0.05), 800, 32, 1),
    ],
)
def test_settings_are_rounded_to_what_a_head_can_do(
    settings: SonarSettings, bins: int, step: int, ad_interval: int
) -> None:
    rounded = head_settings(settings)
    assert rounded.bins == bins
    assert rounded.step == pytest.approx(step * STEP, abs=1e-12)
    assert rounded.bin_length == pytest.approx(ad_interval * 640e-9 * 750.0, abs=1e-12)
    assert head_settings(rounded) == rounded


def test_receipts_are_late_by_the_echo_the_line_and_a_little() -> None:
    record = recorded(SETTINGS)
    late = np.array([time for time, _ in packets(record)])
    late -= record.settings.beam_period * np.arange(len(late))
    least = 0.0133 + 0.005 + 245 * 10 / 115200
    assert late.min() >= least - 1e-4
    assert late.min() < least + 1e-3
    assert late.max() < least + 0.01
    assert np.ptp(late) > 1e-3


def test_a_sector_has_no_raw_form() -> None:
    with pytest.raises(UserError, match="full turns alone"):
        head_settings(replace(SETTINGS, sector=np.radians(90.0)))


def test_a_raw_bag_holds_bytes_received_and_no_beams(tmp_path: Path) -> None:
    bag = simulate(short_world(), 4, tmp_path, raw=True).bag
    opened = open_recording(bag)
    assert set(opened.topics) == {"/sonar/raw", "/imu/data", "/pressure", "/ground_truth"}
    raws = [
        (raw.log_ns, decoding.raw_bytes(decode(raw.data, topics.SONAR_RAW.type_name)))
        for raw in opened.messages(["/sonar/raw"])
    ]
    assert all(raw.received_ns == log_ns for log_ns, raw in raws)
    assert all(raw.data[:1] == b"@" and raw.data[-1:] == b"\n" for _, raw in raws)
    assert [log_ns for log_ns, _ in raws] == sorted(log_ns for log_ns, _ in raws)


def test_the_same_seed_gives_the_same_bytes(tmp_path: Path) -> None:
    first, again = (simulate(short_world(), 4, tmp_path / n, raw=True).bag for n in ("a", "b"))
    assert (first / "pond_4.mcap").read_bytes() == (again / "pond_4.mcap").read_bytes()


def test_the_other_sensors_are_those_of_the_plain_bag(tmp_path: Path) -> None:
    raw = simulate(short_world(), 4, tmp_path / "raw", raw=True)
    plain = simulate(short_world(), 4, tmp_path / "plain")
    assert raw.ground_truth.read_bytes() == plain.ground_truth.read_bytes()
    for topic in ("/imu/data", "/pressure", "/ground_truth"):
        ones, others = (
            [(message.log_ns, message.data) for message in open_recording(bag).messages([topic])]
            for bag in (raw.bag, plain.bag)
        )
        assert ones == others


@pytest.mark.parametrize("raw", [True, False])
def test_the_command_passes_its_option_on(
    raw: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    asked: list[object] = []

    def instead(*_: object, **options: object) -> SimulatedBag:
        asked.append(options["raw"])
        return SimulatedBag(tmp_path, tmp_path)

    monkeypatch.setattr(recording, "simulate", instead)
    options = ["--raw"] if raw else []
    assert main(["simulate", "pond", "--seed", "1", "--out", str(tmp_path), *options]) == 0
    assert asked == [raw]
    assert str(tmp_path) in capsys.readouterr().out
