# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""A bag with nothing but the head's bytes: the nodes make of it what the offline run makes."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from command_line import msss
from nodes.processes import Domain, live

from msss_graphslam.messages import topics
from msss_graphslam.recordings.reader import open_recording
from msss_graphslam.recordings.typestore import decode
from msss_graphslam.recordings.writer import BagWriter
from msss_graphslam.simulation.path import Path as Lap
from msss_graphslam.simulation.recording import simulate
from msss_graphslam.simulation.settings import SonarSettings
from msss_graphslam.simulation.worlds import World

pytestmark = pytest.mark.slow

LIMIT = 120.0


@pytest.fixture(scope="module")
def raw_bag(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A minute in a tank, recorded as the bytes of the head's port."""
    x = [-4.5, 4.5, 4.5, 3.0, 3.0, -4.5]
    y = [-3.5, -3.5, 1.5, 1.5, 3.5, 3.5]
    angles = np.linspace(0.0, 2.0 * np.pi, 9)[:-1]
    circle = np.column_stack([np.cos(angles), np.sin(angles)])
    world = World(
        name="raw_tank",
        outlines=(np.column_stack([x, y]) - circle[0],),
        path=Lap.through(circle - circle[0]),
        laps=1,
        depth=1.0,
        rough=False,
        sonar=SonarSettings(10.0, 100, np.radians(3.6), 0.0854),
    )
    return simulate(world, 1, tmp_path_factory.mktemp("raw"), raw=True).bag


@pytest.fixture(scope="module")
def offline(raw_bag: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("offline")
    done = msss("run", raw_bag, "--out", out)
    assert done.returncode == 0, done.stderr
    return out


def summary(folder: Path) -> dict[str, Any]:
    content = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    assert isinstance(content, dict)
    return content


def assert_same(live_run: Path, offline: Path) -> None:
    for name in ("trajectory.tum", "keyframes.tum", "dead_reckoning.tum"):
        assert (live_run / name).read_bytes() == (offline / name).read_bytes(), name
    for name in ("beams", "scans", "loop_closures", "refused"):
        assert summary(live_run)[name] == summary(offline)[name]


def test_the_bag_holds_bytes_only_and_gives_scans(raw_bag: Path, offline: Path) -> None:
    assert open_recording(raw_bag).sonar_topic == topics.SONAR_RAW
    assert summary(offline)["scans"] >= 4
    assert summary(offline)["position_error_m"]["full"]["mean"] < 0.5


@pytest.mark.parametrize("rate", [0, 8])
def test_the_driver_and_the_nodes_make_the_same_bytes(
    raw_bag: Path, offline: Path, at: Domain, tmp_path: Path, rate: int
) -> None:
    with live(at, "--replay", raw_bag, "--rate", rate, "--out", tmp_path / "live") as process:
        assert process.wait(LIMIT) == 0
    assert (tmp_path / "live" / "log" / "micron_driver.log").exists()
    assert_same(tmp_path / "live", offline)


def test_bytes_without_their_times_have_those_of_the_log(
    raw_bag: Path, offline: Path, at: Domain, tmp_path: Path
) -> None:
    bare = without_labels(raw_bag, tmp_path / "bare")
    done = msss("run", bare, "--out", tmp_path / "run")
    assert done.returncode == 0
    with live(at, "--replay", bare, "--rate", 0, "--out", tmp_path / "live") as process:
        assert process.wait(LIMIT) == 0
    for folder in (tmp_path / "run", tmp_path / "live"):
        assert_same(folder, offline)


def test_what_is_recorded_of_it_has_both_and_is_read_by_its_pings(
    raw_bag: Path, at: Domain, tmp_path: Path
) -> None:
    arguments = ("--replay", raw_bag, "--rate", 0, "--record", tmp_path / "dive")
    with live(at, *arguments, "--out", tmp_path / "live") as process:
        assert process.wait(LIMIT) == 0
    recorded = open_recording(tmp_path / "dive")
    assert recorded.find(topics.SONAR_RAW) is not None
    assert recorded.sonar_topic == topics.SONAR_PING
    assert recorded.topics["/sonar/ping"].count == summary(tmp_path / "live")["beams"]


def without_labels(bag: Path, out: Path) -> Path:
    """Copy the bag, its raw bytes without their times of receipt."""
    recording = open_recording(bag)
    with BagWriter(out) as writer:
        for raw in recording.messages():
            kind = recording.topics[raw.channel.topic].type_name
            message = decode(raw.data, kind)
            if kind == topics.SONAR_RAW.type_name:
                message.layout.dim = []
            writer.write(raw.channel.topic, message, raw.log_ns)
    return out
