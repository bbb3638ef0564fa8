# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""However it ends: with exit code 0 and whole files, or, killed, with no half file."""

import signal
import sys
from pathlib import Path

import pytest
from nodes.processes import Domain, NodeProcess, wait_until
from system.comparison import assert_same, summary
from system.fleet import Fleet
from system.missions import Mission, run_offline
from system.witness import Witness

from msss_graphslam.recordings.reader import open_recording

pytestmark = pytest.mark.slow

_PROMISED = 3.0
"""So long a node may take to end [s]; after that it is killed, and the test fails."""

_FILES = (
    "trajectory.tum",
    "online.tum",
    "dead_reckoning.tum",
    "keyframes.tum",
    "graph.g2o",
    "constraints.csv",
    "map.ply",
    "map.pgm",
    "map.yaml",
    "result.mcap",
    "report.html",
    "summary.json",
)
_SAME_BYTES = ("trajectory.tum", "dead_reckoning.tum", "keyframes.tum", "graph.g2o", "map.ply")


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_every_node(
    pond: Mission, own_domain: Domain, tmp_path: Path, number: int
) -> None:
    with Fleet(own_domain, tmp_path / "live") as fleet, Witness(own_domain) as witness:
        fleet.start()
        replay = fleet.replay(pond.bag, 20)
        witness.wait_for_keyframes(2)
        for node in (*fleet.nodes.values(), replay):
            node.signal(number)
        for name, node in {**fleet.nodes, "bag_replay": replay}.items():
            assert node.wait(_PROMISED) == 0, f"{name}:\n{node.output}"
            assert "Traceback" not in node.output, f"{name}:\n{node.output}"


def test_live_ends_with_its_files_on_ctrl_c(
    pond: Mission, own_domain: Domain, tmp_path: Path
) -> None:
    with _live(own_domain, tmp_path / "live", pond) as live, Witness(own_domain) as witness:
        witness.wait_for_keyframes(4)
        code = live.interrupt()
    assert code in (0, 3), live.output
    assert {path.name for path in (tmp_path / "live").iterdir()} >= set(_FILES)
    assert 4 <= summary(tmp_path / "live")["scans"] <= summary(pond.offline)["scans"]


def test_live_ends_by_itself_with_the_bag_and_the_result(
    pond: Mission, own_domain: Domain, tmp_path: Path
) -> None:
    recorded = tmp_path / "recorded"
    with _live(own_domain, tmp_path / "live", pond, "--record", str(recorded)) as live:
        assert live.wait() == 0, live.output
    assert_same(tmp_path / "live", pond.offline)
    topics, inputs = open_recording(recorded).topics, open_recording(pond.bag).topics
    for name in ("/sonar/ping", "/imu/data", "/pressure"):
        assert topics[name].count == inputs[name].count
    assert topics["/pose"].count > 0
    assert_same(run_offline(recorded, tmp_path / "again").offline, pond.offline)


@pytest.mark.parametrize("first", ["trajectory.tum", "result.mcap"])
def test_a_back_end_killed_while_it_saves_leaves_whole_files_and_is_asked_again(
    pond: Mission, own_domain: Domain, tmp_path: Path, first: str
) -> None:
    with Fleet(own_domain, tmp_path / "live") as fleet:
        fleet.start()
        replay = fleet.replay(pond.bag, 0)
        wait_until(lambda: (fleet.output / first).exists(), first)
        fleet.kill("back_end")
        left = {path.name for path in fleet.output.iterdir() if not path.name.startswith(".")}
        for name in left.intersection(_SAME_BYTES):
            assert (fleet.output / name).read_bytes() == (pond.offline / name).read_bytes()
        fleet.start("back_end")
        fleet.finish(replay)
    assert_same(fleet.output, pond.offline)
    assert {path.name for path in fleet.output.iterdir()} >= set(_FILES)


def _live(domain: Domain, output: Path, mission: Mission, *options: str) -> NodeProcess:
    command = [sys.executable, "-m", "msss_graphslam", "live", "--out", str(output)]
    command += ["--replay", str(mission.bag), "--rate", "20", *options]
    return NodeProcess(command, domain)
