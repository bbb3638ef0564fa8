# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Real child processes: started, started again, ended in order, and never left behind."""

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from stand_ins import NODE, is_alive, stand_in, wait_until

from msss_graphslam.live.process import Command
from msss_graphslam.live.supervisor import Supervisor, describe_end

ROOT = Path(__file__).parents[2]

STUBBORN = NODE.replace("signal.signal(signal.SIGINT, end)", "signal.signal(signal.SIGINT, 1)")
STUBBORN = STUBBORN.replace("SIGINT, 1", "SIGINT, signal.SIG_IGN")
DEAF = STUBBORN.replace("signal.SIGTERM, end", "signal.SIGTERM, signal.SIG_IGN")

PARENT = """
import sys, time
from pathlib import Path
sys.path[:0] = {path!r}
from stand_ins import NODE, stand_in
from msss_graphslam.live.supervisor import Supervisor
deaf = NODE.replace(", end)", ", signal.SIG_IGN)")
supervisor = Supervisor([stand_in("one", deaf), stand_in("two")], Path({logs!r}), print)
supervisor.start()
print("started", flush=True)
time.sleep(60)
"""


class Watch:
    """A supervisor over stand-ins, what it says, and the clock that it goes by."""

    def __init__(self, logs: Path) -> None:
        self.logs = logs
        self.said: list[str] = []
        self.heard: list[tuple[str, str]] = []
        self.now = 0.0
        self.supervisor: Supervisor | None = None

    def start(self, *commands: Command) -> Supervisor:
        self.supervisor = Supervisor(
            commands,
            self.logs,
            self.said.append,
            heard=lambda name, line: self.heard.append((name, line)),
            clock=lambda: self.now,
        )
        self.supervisor.start()
        return self.supervisor

    def pids(self, name: str) -> list[int]:
        lines = (self.logs / f"{name}.log").read_text(encoding="utf-8").splitlines()
        return [int(line.split()[1]) for line in lines if line.startswith("pid ")]

    def wait_for_start(self, name: str, times: int = 1) -> int:
        """Wait until the stand-in has said its pid so many times, and return the last."""
        assert self.supervisor is not None
        wait_until(lambda: len(self.pids(name)) == times, self.supervisor.look)
        return self.pids(name)[-1]


@pytest.fixture
def watch(tmp_path: Path) -> Iterator[Watch]:
    watch = Watch(tmp_path / "log")
    yield watch
    if watch.supervisor is not None:
        watch.supervisor.stop()


def test_all_are_started_and_what_they_say_is_kept_and_heard(watch: Watch) -> None:
    supervisor = watch.start(stand_in("one"), stand_in("two"))
    pids = {name: watch.wait_for_start(name) for name in ("one", "two")}
    assert supervisor.running == ["one", "two"]
    supervisor.look()
    assert sorted(watch.heard) == [(name, f"pid {pid}") for name, pid in sorted(pids.items())]
    assert watch.said == []


def test_they_live_in_sessions_of_their_own(watch: Watch) -> None:
    watch.start(stand_in("one"), stand_in("two"))
    pids = [watch.wait_for_start(name) for name in ("one", "two")]
    assert [os.getsid(pid) for pid in pids] == pids


def test_the_end_comes_by_sigint_first(watch: Watch) -> None:
    supervisor = watch.start(stand_in("one"), stand_in("two"))
    for name in ("one", "two"):
        watch.wait_for_start(name)
    supervisor.stop()
    assert supervisor.running == []
    for name in ("one", "two"):
        assert (watch.logs / f"{name}.log").read_text().splitlines()[1:] == ["got SIGINT"]
        assert supervisor.exit_code(name) == 0
    assert watch.said == []


def test_who_does_not_heed_is_sent_more(watch: Watch) -> None:
    supervisor = watch.start(stand_in("slow", STUBBORN), stand_in("deaf", DEAF))
    for name in ("slow", "deaf"):
        watch.wait_for_start(name)
    supervisor.stop()
    assert (supervisor.exit_code("slow"), supervisor.exit_code("deaf")) == (0, -signal.SIGKILL)
    assert (watch.logs / "slow.log").read_text().endswith("got SIGTERM\n")
    assert watch.said == [
        "slow: does not end, sent SIGTERM",
        "deaf: does not end, sent SIGTERM",
        "deaf: does not end, sent SIGKILL",
    ]


def test_one_can_be_ended_alone_and_stays_away(watch: Watch) -> None:
    supervisor = watch.start(stand_in("one"), stand_in("two"))
    for name in ("one", "two"):
        watch.wait_for_start(name)
    supervisor.stop("one")
    watch.now = 100.0
    supervisor.look()
    assert supervisor.running == ["two"]
    assert (supervisor.failed, supervisor.restarts, watch.said) == ({}, {}, [])


def test_a_killed_one_comes_back_after_its_pause(watch: Watch) -> None:
    supervisor = watch.start(stand_in("one"), stand_in("two"))
    pid, other = watch.wait_for_start("one"), watch.wait_for_start("two")
    os.kill(pid, signal.SIGKILL)
    wait_until(lambda: bool(watch.said), supervisor.look)
    assert watch.said == ["one: ended by signal 9 (Killed), started again"]
    supervisor.look()
    assert supervisor.running == ["two"]
    watch.now = 0.5
    assert watch.wait_for_start("one", 2) != pid
    assert supervisor.restarts == {"one": 1}
    assert (supervisor.failed, watch.pids("two")) == ({}, [other])


def test_who_dies_too_often_is_given_up_with_its_last_words(watch: Watch) -> None:
    supervisor = watch.start(stand_in("one", "print('no port'); raise SystemExit(7)"))

    def look() -> None:
        watch.now += 0.5
        supervisor.look()

    wait_until(lambda: bool(supervisor.failed), look)
    log = watch.logs / "one.log"
    assert supervisor.failed == {"one": f"ended with exit code 7 too often: no port (see {log})"}
    assert log.read_text() == "no port\n" * 6
    assert len(watch.said) == 6
    look()
    assert supervisor.running == []


def test_who_runs_once_may_end_but_not_fail(watch: Watch) -> None:
    supervisor = watch.start(
        stand_in("good", "pass", returns=False),
        stand_in("bad", "raise SystemExit('no such bag')", returns=False),
    )
    ends = ("good", "bad")
    wait_until(lambda: None not in map(supervisor.exit_code, ends), supervisor.look)
    supervisor.look()
    assert list(supervisor.failed) == ["bad"]
    assert "ended with exit code 1: no such bag" in supervisor.failed["bad"]
    assert supervisor.restarts == {}


def test_warnings_are_passed_on_under_the_nodes_name(watch: Watch) -> None:
    script = "print('[WARN] [1.5] [x]: late'); print('[INFO] [1.5] [x]: fine')\n" + NODE
    supervisor = watch.start(stand_in("one", script))
    watch.wait_for_start("one")
    supervisor.look()
    assert watch.said == ["one: warning: late"]


def test_an_old_log_is_not_taken_for_a_new_one(watch: Watch) -> None:
    watch.logs.mkdir()
    (watch.logs / "one.log").write_text("[ERROR] [1.5] [x]: of yesterday\n")
    supervisor = watch.start(stand_in("one"))
    watch.wait_for_start("one")
    supervisor.look()
    assert watch.said == []
    assert "yesterday" not in (watch.logs / "one.log").read_text()


def test_none_outlives_a_parent_that_is_killed(tmp_path: Path) -> None:
    path = [str(ROOT), str(ROOT / "test")]
    script = PARENT.format(path=path, logs=str(tmp_path))
    parent = subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, text=True)
    assert parent.stdout is not None
    assert parent.stdout.readline() == "started\n"
    logs = [tmp_path / "one.log", tmp_path / "two.log"]
    wait_until(lambda: all(log.read_text().endswith("\n") for log in logs))
    pids = [int(log.read_text().split()[1]) for log in logs]
    assert all(map(is_alive, pids))
    parent.kill()
    parent.wait()
    parent.stdout.close()
    wait_until(lambda: not any(map(is_alive, pids)))


def test_ends_are_told_in_words() -> None:
    assert describe_end(3) == "ended with exit code 3"
    assert describe_end(-15) == "ended by signal 15 (Terminated)"
