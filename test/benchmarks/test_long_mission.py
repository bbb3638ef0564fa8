# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The benchmark of long missions: what it simulates, what it measures, what it writes."""

from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from benchmarks.long_figures import agreement_table, draw, end_table, growth_table
from benchmarks.long_mission import page
from benchmarks.long_run import FirstRange, measure, measurements
from benchmarks.long_simulation import LongMission, simulate
from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.types import Array, Beam, Depth, Inertial
from msss_graphslam.simulation.worlds import World, world_named


def coarse_pond() -> World:
    """The pond with a head that takes 20 beams a turn, in the same time."""
    pond = world_named("pond")
    sonar = replace(pond.sonar, step=10.0 * pond.sonar.step, beam_period=0.427)
    return replace(pond, sonar=sonar)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("long")
    simulate(LongMission(world_named("pond"), 1, 4), folder)
    return folder


@pytest.fixture(scope="module")
def measured(folder: Path) -> dict[str, Array]:
    return measure(folder, world_named("pond").sonar.ranges, "full")


def columns(scans: int) -> dict[str, Array]:
    """Figures that grow by one from scan to scan, with ten beams a scan."""
    number = np.arange(scans, dtype=float)
    return {
        "seconds": 1e-3 * number,
        "mib": 100.0 + number,
        "edges": np.full(scans, 4.0),
        "loops": np.full(scans, 3.0),
        "points": np.full(scans, 170.0),
        "online_m": 0.1 * np.repeat(number, 10),
        "final_m": np.full(10 * scans, 0.05),
        "aligned_m": np.full(10 * scans, 0.01),
        "finish_s": np.array(12.0),
        "before_finish_s": np.array(13.0),
        "peak_mib": np.array([200.0, 300.0]),
        "mission_s": np.array(7200.0),
    }


def test_a_mission_has_the_turns_that_were_asked_for(measured: dict[str, Array]) -> None:
    assert len(measured["seconds"]) == len(measured["mib"]) == 4
    assert len(measured["edges"]) == 5  # the last part turn is taken in at the end
    assert (measured["seconds"] > 0.0).all()
    assert (np.diff(measured["peak_mib"]) >= 0.0).all()


def test_ranges_alone_are_enough_to_follow_the_vehicle(measured: dict[str, Array]) -> None:
    assert measured["points"][:4].min() > 130
    assert measured["aligned_m"].mean() < 0.05
    assert measured["online_m"].mean() < 0.5


def test_measurements_come_in_order_and_of_every_sensor(folder: Path) -> None:
    (file,) = folder.glob("*.npz")
    ranges = world_named("pond").sonar.ranges
    found = list(measurements(file, ranges))
    stamps = [entry.stamp_ns for entry in found]
    assert stamps == sorted(stamps)
    assert {type(entry) for entry in found} == {Inertial, Depth, Beam}
    depths = [entry.z for entry in found if isinstance(entry, Depth)]
    assert np.mean(depths) == pytest.approx(-world_named("pond").depth, abs=0.3)


def test_a_beam_without_an_echo_is_an_empty_reading() -> None:
    config = Configuration()
    segmenter = FirstRange(config.sonar, config.segmentation)
    heard, silent = (
        segmenter.segment(Beam(7, 0.5, np.array(ranges), np.array([20.0])))
        for ranges in ([3.0], [])
    )
    assert (heard.ranges.tolist(), heard.maximum_range) == ([3.0], 20.0)
    assert heard.ranges.shape == heard.variances.shape == heard.levels.shape
    assert silent.ranges.shape == silent.variances.shape == (0,)
    assert (silent.stamp_ns, silent.bearing) == (7, 0.5)


def test_the_same_mission_with_echoes_has_the_same_motion(tmp_path: Path) -> None:
    missions = [LongMission(coarse_pond(), 2, 3, echoes=echoes) for echoes in (False, True)]
    files = []
    for name, mission in zip(("ranges", "echoes"), missions, strict=True):
        (tmp_path / name).mkdir()
        simulate(mission, tmp_path / name)
        (file,) = (tmp_path / name).glob("*.npz")
        files.append(dict(np.load(file)))
    ranges, echoes = files
    np.testing.assert_array_equal(ranges["inertial_1"], echoes["inertial_1"])
    np.testing.assert_array_equal(ranges["beam_1"], echoes["beam_1"])
    assert ranges["beam_2"].shape == (len(ranges["beam_0"]),)
    assert echoes["beam_2"].shape == (len(echoes["beam_0"]), 350)
    np.testing.assert_allclose(ranges["beam_3"], echoes["beam_3"], atol=0.01)


def test_a_simulation_in_many_files_loses_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    mission = LongMission(coarse_pond(), 1, 5)
    (tmp_path / "one").mkdir()
    simulate(mission, tmp_path / "one")
    monkeypatch.setattr("benchmarks.long_simulation.SLICE_S", 10.0)
    (tmp_path / "many").mkdir()
    simulate(mission, tmp_path / "many")
    files = sorted((tmp_path / "many").glob("*.npz"))
    assert len(files) > 3
    ranges = mission.world.sonar.ranges
    (one,) = (tmp_path / "one").glob("*.npz")
    whole = [entry.stamp_ns for entry in measurements(one, ranges)]
    assert [entry.stamp_ns for file in files for entry in measurements(file, ranges)] == whole


def test_growth_looks_at_the_scans_before() -> None:
    rows = growth_table(columns(2000)).rows
    assert [row[0] for row in rows] == ["100", "300", "1000", "2000"]
    assert [row[1] for row in rows] == ["50", "150", "750", "1750"]
    assert [row[2] for row in rows] == ["99", "297", "995", "1995"]
    assert [row[3] for row in rows] == ["199", "399", "1099", "2099"]
    assert rows[-1][5] == f"{0.1 * (1500 + 1999) / 2:.3f}"


def test_the_tables_stand_in_the_page() -> None:
    long, short = columns(1200), columns(300)
    text = page("the command", long, short, short)
    for table in (growth_table(long), end_table(long), agreement_table(short, short)):
        assert table.markdown() in text
    assert "the command" in text
    assert "{" not in text


def test_the_whole_names_both_peaks() -> None:
    rows = dict(end_table(columns(300)).rows)
    assert rows["mission [h]"] == "2.0"
    assert rows["peak memory until the last scan [MiB]"] == "200"
    assert rows["peak memory with it [MiB]"] == "300"


def test_the_picture_is_the_same_every_time(tmp_path: Path) -> None:
    first, second = tmp_path / "first.svg", tmp_path / "second.svg"
    draw(columns(1250), first)
    draw(columns(1250), second)
    assert first.read_bytes() == second.read_bytes()
    assert ElementTree.parse(first).getroot().tag.endswith("svg")  # noqa: S314
