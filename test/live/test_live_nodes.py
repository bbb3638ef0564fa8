# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The command with the real nodes, each test in a ROS domain of its own."""

import json
import os
import signal
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from command_line import msss
from stand_ins import is_alive
from stand_ins import wait_until as wait_long

from msss_graphslam.simulation.recording import SimulatedBag

pytest.importorskip("rclpy")
from nodes.processes import Domain, domain, live, wait_until

pytestmark = pytest.mark.slow

LIMIT = 120.0


@pytest.fixture
def ros() -> Iterator[Domain]:
    with domain() as number:
        yield number


def children_of(pid: int) -> dict[str, int]:
    """Return the pids of a process's nodes by name."""
    found = {}
    for number in Path(f"/proc/{pid}/task/{pid}/children").read_text().split():
        words = Path(f"/proc/{number}/cmdline").read_bytes().decode().split("\0")
        if "--ros-args" in words:
            found[words[words.index("-m") + 1].rpartition(".")[2]] = int(number)
    return found


def test_it_leaves_what_run_leaves(tank: SimulatedBag, tmp_path: Path, ros: Domain) -> None:
    with live(ros, "--replay", tank.bag, "--rate", 0, "--out", tmp_path / "live") as process:
        assert process.wait(LIMIT) == 0
        assert f"report: {tmp_path / 'live' / 'report.html'}" in process.output
        assert "full, online" in process.output
    assert msss("run", tank.bag, "--out", tmp_path / "run").returncode == 0
    left = {path.name for path in (tmp_path / "live").iterdir()}
    assert left == {path.name for path in (tmp_path / "run").iterdir()} | {"log"}
    offline, online = (np.loadtxt(tmp_path / name / "trajectory.tum") for name in ("run", "live"))
    np.testing.assert_allclose(online, offline, atol=1e-6)
    known, published = (
        np.loadtxt(tmp_path / name / "online.tum")[:, 0] for name in ("run", "live")
    )
    assert published[0] == pytest.approx(known[0], abs=0.05)
    assert np.diff(published).max() < 0.5


def test_ctrl_c_saves_and_records_what_there_was(
    tank: SimulatedBag, tmp_path: Path, ros: Domain
) -> None:
    out, dive = tmp_path / "out", tmp_path / "dive"
    with live(ros, "--replay", tank.bag, "--rate", 2, "--out", out, "--record", dive) as process:
        process.wait_for_output(r"[3-8]\d % bag_replay")
        nodes = children_of(process.pid)
        assert len(nodes) == 6
        assert process.interrupt(LIMIT) == 0
    assert not any(map(is_alive, nodes.values()))
    assert json.loads((out / "summary.json").read_text())["scans"] >= 1
    recorded = json.loads(msss("inspect", dive, "--json").stdout)
    assert "/pose" in {topic["name"] for topic in recorded["topics"] if topic["count"]}


def test_a_killed_node_joins_in_again(tank: SimulatedBag, tmp_path: Path, ros: Domain) -> None:
    with live(ros, "--replay", tank.bag, "--rate", 4, "--out", tmp_path / "out") as process:
        process.wait_for_output(r"[3-8]\d % bag_replay")
        os.kill(children_of(process.pid)["front_end"], signal.SIGKILL)
        process.wait_for_output("front_end: ended by signal 9")
        assert process.wait(LIMIT) in (0, 3)
        assert "front_end: started again 1 x" in process.output


def test_no_node_outlives_it(tank: SimulatedBag, tmp_path: Path, ros: Domain) -> None:
    with live(ros, "--replay", tank.bag, "--out", tmp_path / "out") as process:
        wait_until(lambda: len(children_of(process.pid)) == 5)
        nodes = children_of(process.pid)
        process.kill()
    wait_long(lambda: not any(map(is_alive, nodes.values())))
