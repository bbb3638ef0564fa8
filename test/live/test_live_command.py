# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The command: what it refuses before anything is started, and how it shows what was written."""

import json
import re
from pathlib import Path

import pytest
from command_line import assert_one_line, msss
from sample_bags import START_NS, beam_message, write_bag

from msss_graphslam.cli.commands import live
from msss_graphslam.cli.console import Console
from msss_graphslam.cli.exit_codes import ExitCode
from msss_graphslam.cli.live_result import show_result
from msss_graphslam.cli.main import main
from msss_graphslam.config.configuration import Configuration
from msss_graphslam.errors import UserError
from msss_graphslam.live import run as live_run
from msss_graphslam.live.command_table import Setup
from msss_graphslam.live.session import Outcome
from msss_graphslam.messages import encoding
from msss_graphslam.nodes.names import SLAM_NODES
from msss_graphslam.recordings.typestore import make
from msss_graphslam.simulation.recording import SimulatedBag

Captured = pytest.CaptureFixture[str]


@pytest.fixture
def session(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Take the place of the session: note the nodes that would be started, write nothing."""
    started: list[str] = []

    def pretend(commands: list[object], *_: object, **__: object) -> Outcome:
        started.extend(command.name for command in commands)  # type: ignore[attr-defined]
        return Outcome({}, {}, {"back_end": "no beam yet"})

    monkeypatch.setattr(live_run, "run_session", pretend)
    return started


def setup_of(tmp_path: Path, **values: Path) -> Setup:
    return Setup(tmp_path / "out", "full", Configuration(), **values)


def run(setup: Setup) -> Outcome:
    return live_run.run(setup, lambda text: None, lambda share, what: None)  # noqa: ARG005


def test_it_has_help() -> None:
    done = msss("live", "--help")
    assert done.returncode == 0
    options = ("--out", "--replay", "--rate", "--sonar", "--record", "--namespace", "--set")
    for option in (*options, "--json"):
        assert option in done.stdout


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("live",), "required: --out"),
        (("live", "--out", "o", "--rate", "-1"), "must be a number from 0 on"),
        (("live", "--out", "o", "--rate", "inf"), "must be a number from 0 on"),
        (("live", "--out", "o", "--rate", "nan"), "must be a number from 0 on"),
        (("live", "--out", "o", "--rate", "fast"), "must be a number from 0 on"),
        (("live", "--out", "o", "--namespace", "a b"), "must be names of letters"),
        (("live", "--out", "o", "--namespace", "1a"), "must be names of letters"),
        (("live", "--out", "o", "--namespace", "a//b"), "must be names of letters"),
        (("live", "--out", "o", "--estimator", "none"), "unknown estimator 'none'"),
    ],
)
def test_a_wrong_command_is_one_line_and_exit_code_2(
    arguments: tuple[str, ...], said: str
) -> None:
    done = msss(*arguments)
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1)
    assert said in done.stderr


def test_without_ros_it_is_one_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Captured
) -> None:
    monkeypatch.setattr(live_run, "find_spec", lambda _: None)
    assert main(["live", "--out", str(tmp_path / "out")]) == ExitCode.CANNOT_GO_ON
    out, err = capsys.readouterr()
    assert (out, err.count("\n")) == ("", 1)
    assert err.startswith("msss: rclpy is missing: source ROS 2 Jazzy")
    assert list(tmp_path.iterdir()) == []


def test_a_missing_bag_is_named_and_nothing_is_left(tmp_path: Path) -> None:
    done = msss("live", "--replay", "nothing", "--out", "out", cwd=tmp_path)
    assert_one_line(done)
    assert "msss: nothing: " in done.stderr
    assert list(tmp_path.iterdir()) == []


def test_nothing_is_recorded_over_a_bag(tmp_path: Path, session: list[str]) -> None:
    (tmp_path / "dive").mkdir()
    with pytest.raises(UserError, match="exists already"):
        run(setup_of(tmp_path, record=tmp_path / "dive"))
    assert session == []


def test_results_of_an_earlier_run_are_not_taken_for_new_ones(
    tmp_path: Path, session: list[str]
) -> None:
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "summary.json").write_text("{}")
    with pytest.raises(UserError, match="nothing written, back_end: no beam yet"):
        run(setup_of(tmp_path))
    assert session == list(SLAM_NODES)


@pytest.mark.parametrize(
    ("written", "said"),
    [
        ((), "nothing was written"),
        (("map.ply", ".map.7.pgm", "keyframes.tum"), "all but keyframes.tum, map.ply is lost"),
    ],
)
@pytest.mark.parametrize("option", ["--record", "--replay", ""])
def test_a_second_signal_is_exit_code_1_and_says_what_is_lost(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: Captured,
    written: tuple[str, ...],
    said: str,
    option: str,
) -> None:
    out, bag = tmp_path / "out", tmp_path / "dive"
    if option == "--replay":
        bag = write_bag(bag)
    out.mkdir()
    (out / "trajectory.tum").write_text("of an earlier run")

    def break_off(*_: object, **__: object) -> Outcome:
        for name in written:
            (out / name).write_text("")
        raise KeyboardInterrupt

    monkeypatch.setattr(live_run, "run_session", break_off)
    options = [option, str(bag)] if option else []
    assert main(["live", "--out", str(out), *options]) == ExitCode.CANNOT_GO_ON
    err = capsys.readouterr().err
    assert err.count("\n") == 1
    assert f"ended by the second signal, {said};" in err
    assert (f"`msss run {bag} --out {out}`" if option else "no bag has it") in err


@pytest.mark.parametrize(
    ("arguments", "is_started"),
    [
        ((), False),
        (("--sonar", "micron"), True),
        (("--set", "micron.port=/dev/ttyS0"), True),
        (("--sonar", "none", "--set", "micron.port=/dev/ttyS0"), False),
        (("--set", "sonar.mount_x=0.1"), False),
    ],
)
def test_the_driver_is_started_by_those_who_want_it(
    tmp_path: Path, session: list[str], arguments: tuple[str, ...], is_started: bool
) -> None:
    assert main(["live", "--out", str(tmp_path / "out"), *arguments]) == ExitCode.CANNOT_GO_ON
    assert session == ["micron_driver"] * is_started + list(SLAM_NODES)


def test_a_replay_takes_the_driver_where_the_bag_has_only_raw_bytes(
    tmp_path: Path, session: list[str]
) -> None:
    raw = encoding.raw_bytes(make, b"@", START_NS)
    ping = beam_message(0)
    both = [("/sonar/raw", raw, START_NS), ("/sonar/ping", ping, START_NS)]
    for name, messages in (("raw", both[:1]), ("both", both)):
        bag = write_bag(tmp_path / name, messages)
        with pytest.raises(UserError, match="nothing written"):
            run(setup_of(tmp_path, replay=bag))
    nodes = [*SLAM_NODES, "bag_replay"]
    assert session == ["micron_driver", *nodes, *nodes]


def test_a_replay_does_not_take_a_sonar(tmp_path: Path, capsys: Captured) -> None:
    bag = write_bag(tmp_path / "dive")
    arguments = ["live", "--out", str(tmp_path / "out"), "--replay", str(bag), "--sonar", "micron"]
    assert main(arguments) == ExitCode.CANNOT_GO_ON
    assert "--sonar is for a head" in capsys.readouterr().err


def test_a_node_that_did_not_come_back_is_exit_code_1(capsys: Captured) -> None:
    outcome = Outcome({"front_end": "ended with exit code 1"}, {"back_end": 2}, {})
    judged = live._judged(Console(), outcome, ExitCode.DATA_LOST)
    assert judged is ExitCode.CANNOT_GO_ON
    assert capsys.readouterr().err.splitlines() == [
        "back_end: started again 2 x",
        "msss: front_end: ended with exit code 1",
    ]


@pytest.mark.parametrize("code", [ExitCode.CLEAN, ExitCode.DATA_LOST])
def test_a_node_that_came_back_is_no_failure(code: ExitCode) -> None:
    assert live._judged(Console(quiet=True), Outcome({}, {"back_end": 1}, {}), code) is code


@pytest.mark.slow
@pytest.mark.parametrize("estimator", ["full", "dead_reckoning"])
def test_a_directory_is_shown_as_run_shows_it(
    tank: SimulatedBag, tmp_path: Path, capsys: Captured, estimator: str
) -> None:
    done = msss("run", tank.bag, "--out", tmp_path, "--estimator", estimator)
    assert show_result(Console(), tmp_path, tank.bag) is ExitCode.CLEAN
    shown, ran = capsys.readouterr().out.splitlines(), done.stdout.splitlines()
    assert shown[-2:] == ran[-2:]
    for name in ("dead_reckoning", f"{estimator}, online"):
        assert figures(shown, name) == figures(ran, name)[: len(figures(shown, name))]
    assert len(figures(shown, "dead_reckoning")) >= 5


def figures(lines: list[str], name: str) -> list[str]:
    """Return the figures of the row of that name."""
    rows = [
        line.removeprefix(name).lstrip() for line in map(str.strip, lines) if line.startswith(name)
    ]
    return re.split(r" +", rows[0]) if rows else []


@pytest.mark.slow
def test_a_directory_without_a_truth_shows_gaps_and_what_was_lost(
    tank: SimulatedBag, tmp_path: Path, capsys: Captured
) -> None:
    msss("run", tank.bag, "--out", tmp_path, "--quiet")
    summary = json.loads((tmp_path / "summary.json").read_text(encoding="utf-8"))
    summary["refused"] = {"odom_late": 1, "beam_without_bins": 3}
    (tmp_path / "summary.json").write_text(json.dumps(summary), encoding="utf-8")
    assert show_result(Console(), tmp_path, None) is ExitCode.DATA_LOST
    out, err = capsys.readouterr()
    assert "gap [m]" in out
    assert "error [m]" not in out
    assert err == "lost or refused: 3 x beam_without_bins; 1 x odom_late\n"
