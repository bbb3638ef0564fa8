# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Sessions of stand-ins, each in a process of its own that gets the signals."""

import json
import signal
import subprocess
import sys
from collections.abc import Sequence
from contextlib import nullcontext
from dataclasses import dataclass, field
from pathlib import Path

import pytest
from stand_ins import NODE, is_alive, stand_in, wait_until

from msss_graphslam.errors import UserError
from msss_graphslam.live.session import Outcome, Progress, run_session

ROOT = Path(__file__).parents[2]

REPLAY = """
import time
for tenth in range(1, 11):
    print(f"[INFO] [1.5] [bag_replay]: replayed {10 * tenth} %: 1.0 s of 9.0 s", flush=True)
    time.sleep(0.1)
"""

SAVING_NODE = f"print('[INFO] [1.5] [one]: saving 50 %: maps', flush=True)\n{NODE}"

WATCHING = """
import sys, time
from pathlib import Path
while Path({log!r}).read_text().count("disk full") < 6:
    time.sleep(0.02)
time.sleep(0.5)
"""
"""A replay that lasts until another has died six times."""

SESSION = """
import json, sys, time
from contextlib import nullcontext
from pathlib import Path
sys.path[:0] = {path!r}
from stand_ins import NODE, stand_in
from msss_graphslam.live.session import run_session

def conclude(names, progress):
    print("concluding", flush=True)
    for _ in range({looks}):
        progress(0.5, "")
        time.sleep(0.05)
    print("concluded", " ".join(names), flush=True)
    return {{}}

commands = [stand_in("one"), stand_in("two")]
outcome = run_session(
    commands,
    Path({logs!r}),
    saving=["one", "two"],
    until=None,
    concluding=nullcontext(conclude),
    say=print,
    progress=lambda *_: None,
)
print("over", json.dumps([outcome.failed, outcome.restarts]), flush=True)
"""


@dataclass
class Record:
    """What a session did."""

    said: list[str] = field(default_factory=list)
    shown: list[tuple[float, str]] = field(default_factory=list)
    concluded: list[list[str]] = field(default_factory=list)
    refusal: str = ""

    def run(self, logs: Path, *scripts: tuple[str, str, bool], until: str = "replay") -> Outcome:
        def conclude(names: Sequence[str], progress: Progress) -> dict[str, str]:
            progress(0.0, names[0])
            if self.refusal:
                raise UserError(self.refusal)
            self.concluded.append(list(names))
            return dict.fromkeys(names, "saved")

        return run_session(
            [stand_in(name, script, returns=returns) for name, script, returns in scripts],
            logs,
            saving=[name for name, *_ in scripts if name in ("one", "writer")],
            until=until,
            concluding=nullcontext(conclude),
            say=self.said.append,
            progress=lambda share, what: self.shown.append((share, what)),
        )


def started(script: str) -> "subprocess.Popen[str]":
    return subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, text=True)


def session_in(logs: Path, looks: int = 0) -> "subprocess.Popen[str]":
    """Start a session that runs until a signal, and wait until its nodes are up."""
    path = [str(ROOT), str(ROOT / "test")]
    process = started(SESSION.format(path=path, logs=str(logs), looks=looks))
    wait_until(lambda: all(map(pid_in, (logs / "one.log", logs / "two.log"))))
    return process


def await_line(process: "subprocess.Popen[str]", wanted: str) -> None:
    """Read on until the session says this line; what it says first is left out."""
    assert process.stdout is not None
    for line in process.stdout:
        if line == wanted:
            return
    raise AssertionError(f"never said {wanted!r}")


def pid_in(log: Path) -> int:
    """Return the pid that a stand-in has said, or 0."""
    said, ended, _ = (log.read_text(encoding="utf-8") if log.exists() else "").partition("\n")
    return int(said.split()[1]) if ended else 0


def test_it_ends_with_the_replay_and_has_the_nodes_save(tmp_path: Path) -> None:
    record = Record()
    outcome = record.run(tmp_path, ("one", NODE, True), ("replay", REPLAY, False))
    assert outcome == Outcome({}, {}, {"one": "saved"})
    assert (record.concluded, record.said) == ([["one"]], [])
    assert (tmp_path / "one.log").read_text().endswith("got SIGINT\n")


def test_progress_follows_the_replay_and_never_falls(tmp_path: Path) -> None:
    record = Record()
    record.run(tmp_path, ("one", NODE, True), ("replay", REPLAY, False))
    shares = [share for share, _ in record.shown]
    assert shares == sorted(shares)
    assert (shares[0], shares[-1]) == (0.0, 1.0)
    assert {0.4, 0.8} <= {round(share, 9) for share in shares}
    assert [what for _, what in record.shown][-2:] == ["saving one", "done"]


def test_what_the_last_node_says_of_its_saving_is_shown(tmp_path: Path) -> None:
    record = Record()
    record.run(tmp_path, ("one", SAVING_NODE, True), ("replay", REPLAY, False))
    assert (0.9, "saving maps") in [(round(share, 9), what) for share, what in record.shown]


def test_a_replay_that_fails_ends_the_session_but_the_rest_is_saved(tmp_path: Path) -> None:
    record = Record()
    script = "raise SystemExit('disk gone')"
    outcome = record.run(tmp_path, ("one", NODE, True), ("replay", script, False))
    assert record.concluded == [["one"]]
    assert "disk gone" in outcome.failed["replay"]


def test_a_recorder_that_fails_does_not_end_the_session(tmp_path: Path) -> None:
    record = Record()
    outcome = record.run(
        tmp_path,
        ("one", NODE, True),
        ("recorder", "raise SystemExit('disk full')", True),
        ("replay", WATCHING.format(log=str(tmp_path / "recorder.log")), False),
    )
    assert record.concluded == [["one"]]
    assert list(outcome.failed) == ["recorder"]


def test_without_the_node_that_writes_nothing_is_saved(tmp_path: Path) -> None:
    record = Record()
    with pytest.raises(
        UserError, match="nothing written, writer: ended with exit code 1 too often: no gtsam"
    ):
        record.run(
            tmp_path,
            ("replay", NODE, False),
            ("one", NODE, True),
            ("writer", "raise SystemExit('no gtsam')", True),
        )
    assert record.concluded == []
    assert not is_alive(pid_in(tmp_path / "one.log"))


def test_what_cannot_be_saved_leaves_no_process(tmp_path: Path) -> None:
    record = Record(refusal="no beam")
    with pytest.raises(UserError, match="no beam"):
        record.run(tmp_path, ("one", NODE, True), ("replay", REPLAY, False))
    assert not is_alive(pid_in(tmp_path / "one.log"))


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_it_and_everything_is_saved(tmp_path: Path, number: signal.Signals) -> None:
    process = session_in(tmp_path)
    process.send_signal(number)
    out, _ = process.communicate(timeout=60)
    assert process.returncode == 0
    remark, *rest = out.splitlines()
    assert remark.startswith("ending: ")
    assert rest == ["concluding", "concluded one two", "over [{}, {}]"]
    for name in ("one", "two"):
        assert (tmp_path / f"{name}.log").read_text().splitlines()[1:] == ["got SIGINT"]


def test_a_signal_sent_twice_is_one_wish(tmp_path: Path) -> None:
    process = session_in(tmp_path)
    process.send_signal(signal.SIGINT)
    process.send_signal(signal.SIGTERM)
    out, _ = process.communicate(timeout=60)
    assert process.returncode == 0
    assert "concluded one two" in out


def test_a_second_wish_breaks_off_the_saving_and_leaves_no_process(tmp_path: Path) -> None:
    process = session_in(tmp_path, looks=1200)
    pids = [pid_in(tmp_path / f"{name}.log") for name in ("one", "two")]
    process.send_signal(signal.SIGINT)
    await_line(process, "concluding\n")

    def insist() -> None:
        if process.poll() is None:
            process.send_signal(signal.SIGINT)

    wait_until(lambda: process.poll() is not None, insist)
    assert process.stdout is not None
    process.stdout.close()
    assert process.returncode != 0
    assert not any(map(is_alive, pids))


def test_who_dies_during_the_saving_comes_back(tmp_path: Path) -> None:
    process = session_in(tmp_path, looks=40)
    process.send_signal(signal.SIGINT)
    await_line(process, "concluding\n")
    subprocess.run(["kill", "-9", str(pid_in(tmp_path / "one.log"))], check=True)
    out, _ = process.communicate(timeout=60)
    assert json.loads(out.splitlines()[-1].removeprefix("over ")) == [{}, {"one": 1}]
