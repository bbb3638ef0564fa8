# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The files of a live run, whatever becomes of the process that writes them."""

import os
import signal
from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from promised_files import RUN_FILES
from synthetic_run import synthetic_run

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.types import Estimate, Trajectory
from msss_graphslam.errors import UserError
from msss_graphslam.nodes import saving_process as module
from msss_graphslam.nodes.live_run import LiveRun
from msss_graphslam.nodes.saving_process import SavingProcess
from msss_graphslam.results.directory import ResultDirectory
from msss_graphslam.results.record import Cost

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def estimate() -> Estimate:
    return synthetic_run(6).estimate


def live_run() -> LiveRun:
    cost = Cost(100.0, 2.0, 50.0, {"joint_smoothing": np.array([1.5])})
    return LiveRun(Configuration(), "full", Counter(beam_late=3), 60, cost)


def saved(
    estimate: Estimate, output: Path, recording: str = "", *, killed: bool = False
) -> tuple[list[str], list[str]]:
    """Save; return what was complained of and what was done."""
    complaints: list[str] = []
    done: list[str] = []
    with SavingProcess(recording, complaints.append) as saving:
        if killed:
            os.kill(saving._process.pid, signal.SIGKILL)
        points, _ = saving.save(estimate, live_run(), output, lambda _, what: done.append(what))
    assert len(points)
    assert saving._process.returncode is not None
    return complaints, done


def test_every_file_is_written_and_the_node_s_cost_counts(
    estimate: Estimate, tmp_path: Path
) -> None:
    assert saved(estimate, tmp_path) == ([], ["maps", "files", "figures"])
    assert {path.name for path in tmp_path.iterdir()} >= RUN_FILES
    summary = ResultDirectory(tmp_path).read_summary()
    assert summary["refused"] == {"beam_late": 3}
    assert summary["wall_s"] >= 100.0
    assert summary["cpu_s"] >= 2.0


def test_a_process_that_is_killed_costs_no_file(estimate: Estimate, tmp_path: Path) -> None:
    saved(estimate, tmp_path / "killed", killed=True)
    saved(estimate, tmp_path / "whole")
    for name in ("trajectory.tum", "map.ply", "result.mcap", "figures/maps.png"):
        killed, whole = (tmp_path / each / name for each in ("killed", "whole"))
        assert killed.read_bytes() == whole.read_bytes()


def test_a_process_that_cannot_start_costs_no_file(
    estimate: Estimate, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "_MODULE", "no.such.module")
    saved(estimate, tmp_path)
    assert {path.name for path in tmp_path.iterdir()} >= RUN_FILES


def test_without_its_recording_all_else_is_written(estimate: Estimate, tmp_path: Path) -> None:
    complaints, _ = saved(estimate, tmp_path, "no/such/bag")
    assert len(complaints) == 1
    assert complaints[0].endswith("the report goes without it")


def test_what_cannot_be_written_is_told(estimate: Estimate, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(UserError, match="cannot make this directory"):
        saved(estimate, tmp_path / "file")
    empty = replace(estimate, trajectory=Trajectory(np.empty(0, np.int64), np.empty((0, 6))))
    with pytest.raises(UserError, match="no scan has come in"):
        saved(empty, tmp_path / "out")


def test_work_that_fails_beside_it_ends_it(tmp_path: Path) -> None:
    with pytest.raises(RuntimeError, match="beside"), SavingProcess("", print) as saving:
        raise RuntimeError("beside")
    assert saving._process.returncode is not None
    assert list(tmp_path.iterdir()) == []
