# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Simulating, running, comparing and evaluating, each as a person would."""

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from command_line import Done, assert_one_line, msss
from promised_files import RUN_FILES

from msss_graphslam.core.recipes import ESTIMATORS
from msss_graphslam.simulation.recording import SimulatedBag

pytestmark = pytest.mark.slow

NUMBERS = {
    "duration_s",
    "wall_s",
    "cpu_s",
    "realtime_factor",
    "peak_rss_mib",
    "beams",
    "scans",
}


@pytest.fixture(scope="module")
def run(tank: SimulatedBag, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Done]:
    """The tank's bag, run with the default estimator."""
    out = tmp_path_factory.mktemp("run") / "new" / "out"
    return out, msss("run", tank.bag, "--out", out)


def leaves(value: Any) -> Iterator[Any]:
    """Yield every value of nested dictionaries."""
    for entry in value.values() if isinstance(value, dict) else ():
        yield from leaves(entry)
    if not isinstance(value, dict):
        yield value


def test_a_clean_run_prints_a_table_and_where_the_report_is(run: tuple[Path, Done]) -> None:
    out, done = run
    assert done.returncode == 0
    assert re.search(r"^ *full +\d", done.stdout, flags=re.MULTILINE)
    assert re.search(r"^ *dead_reckoning +\d", done.stdout, flags=re.MULTILINE)
    assert f"report: {out / 'report.html'}" in done.stdout.splitlines()
    assert "\x1b" not in done.stdout + done.stderr


def test_progress_in_a_pipe_is_plain_lines(run: tuple[Path, Done]) -> None:
    progress = [line for line in run[1].stderr.splitlines() if re.match(r" *\d+ % \w", line)]
    assert 3 <= len(progress) <= 60
    assert progress[-1].startswith("100 %")


def test_a_run_leaves_every_file(run: tuple[Path, Done]) -> None:
    out, _ = run
    assert {path.name for path in out.iterdir()} == RUN_FILES
    assert list((out / "figures").glob("*.png"))


def test_the_summary_has_every_figure(run: tuple[Path, Done]) -> None:
    summary = json.loads((run[0] / "summary.json").read_text(encoding="utf-8"))
    assert set(summary) >= NUMBERS
    assert set(summary["loop_closures"]) == {"tried", "accepted"}
    assert set(summary["start_end_gap_m"]) == {"dead_reckoning", "full"}
    for key in ("position_error_m", "online_position_error_m"):
        assert set(summary[key]["full"]) == {"mean", "rmse", "max"}
    assert summary["refused"] == {}
    assert summary["configuration"]["estimator"] == "full"


def test_the_same_bag_gives_the_same_bytes(
    run: tuple[Path, Done], tank: SimulatedBag, tmp_path: Path
) -> None:
    assert msss("run", tank.bag, "--out", tmp_path, "--quiet").returncode == 0
    for name in ("trajectory.tum", "online.tum", "graph.g2o"):
        assert (tmp_path / name).read_bytes() == (run[0] / name).read_bytes()


def test_options_go_before_the_file_and_both_into_the_summary(
    tank: SimulatedBag, tmp_path: Path
) -> None:
    parameters = tmp_path / "parameters.yaml"
    parameters.write_text(
        "/**:\n  ros__parameters:\n    dead_reckoning: {surge_speed: 0.3, surge_noise: 0.01}\n",
        encoding="utf-8",
    )
    done = msss(
        *("run", tank.bag, "--out", tmp_path, "--estimator", "dead_reckoning"),
        *("--json", "--quiet", "--config", parameters, "--set", "dead_reckoning.surge_speed=0.2"),
    )
    assert (done.returncode, done.stderr) == (0, "")
    summary = json.loads(done.stdout)
    assert summary == json.loads((tmp_path / "summary.json").read_text(encoding="utf-8"))
    resolved = summary["configuration"]["dead_reckoning"]
    assert (resolved["surge_speed"], resolved["surge_noise"]) == (0.2, 0.01)
    assert None not in leaves(summary)


def test_lost_data_end_with_exit_code_3(truncated: Path, tmp_path: Path) -> None:
    done = msss("run", truncated, "--out", tmp_path / "out", "--estimator", "dead_reckoning")
    assert done.returncode == 3
    assert "lost or refused: " in done.stderr
    assert "the file ends early" in done.stderr
    assert "the file ends early" in (tmp_path / "out" / "summary.json").read_text()


def test_compare_runs_every_estimator(tank: SimulatedBag, tmp_path: Path) -> None:
    done = msss("compare", tank.bag, "--out", tmp_path, "--json")
    assert done.returncode == 0
    assert list(json.loads(done.stdout)) == list(ESTIMATORS)
    for name in ESTIMATORS:
        assert (tmp_path / name / "trajectory.tum").stat().st_size > 0
    assert (tmp_path / "report.html").exists()
    assert list((tmp_path / "figures").glob("*.png"))


def test_evaluate_agrees_with_the_runs_own_figures(
    run: tuple[Path, Done], tank: SimulatedBag
) -> None:
    done = msss("evaluate", run[0], "--ground-truth", tank.ground_truth, "--json")
    assert done.returncode == 0
    measured = json.loads(done.stdout)["trajectory"]["anchored"]
    summary = json.loads((run[0] / "summary.json").read_text(encoding="utf-8"))
    assert measured == pytest.approx(summary["position_error_m"]["full"], abs=2e-3)


def test_evaluate_prints_a_table(run: tuple[Path, Done], tank: SimulatedBag) -> None:
    done = msss("evaluate", run[0], "--ground-truth", tank.ground_truth)
    assert (done.returncode, done.stderr) == (0, "")
    assert [line.split()[0] for line in done.stdout.splitlines() if re.search(r"\d\.", line)] == [
        "dead_reckoning",
        "trajectory",
        "online",
    ]


@pytest.mark.parametrize("content", [None, b"", b"\xff\xfe", b"1.0 2.0\n", b"a b c d e f g h\n"])
def test_a_truth_that_is_none_is_one_line(
    run: tuple[Path, Done], tmp_path: Path, content: bytes | None
) -> None:
    truth = tmp_path / "truth.tum"
    if content is not None:
        truth.write_bytes(content)
    done = msss("evaluate", run[0], "--ground-truth", truth)
    assert_one_line(done)
    assert str(truth) in done.stderr


def test_evaluate_of_no_run_is_one_line(tank: SimulatedBag, tmp_path: Path) -> None:
    assert_one_line(msss("evaluate", tmp_path / "none", "--ground-truth", tank.ground_truth))


def test_an_output_that_is_a_file_is_one_line(tank: SimulatedBag, tmp_path: Path) -> None:
    (tmp_path / "out").write_text("not a directory")
    done = msss("run", tank.bag, "--out", tmp_path / "out", "--estimator", "dead_reckoning")
    assert_one_line(done)
    assert str(tmp_path / "out") in done.stderr


def test_simulate_overwrites_nothing(tmp_path: Path) -> None:
    (tmp_path / "pond_1").mkdir()
    (tmp_path / "pond_1" / "kept").write_text("kept")
    done = msss("simulate", "pond", "--seed", "1", "--out", tmp_path, "--quiet")
    assert_one_line(done)
    assert (tmp_path / "pond_1" / "kept").read_text() == "kept"
