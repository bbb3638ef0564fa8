# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What is said of a line and its head, on both sides of every limit."""

from collections import Counter
from dataclasses import dataclass, field
from types import SimpleNamespace
from typing import Any

import pytest

pytest.importorskip("rclpy")

from msss_graphslam.config.groups import Micron
from msss_graphslam.micron.head_driver import HeadDriver
from msss_graphslam.micron.settings import HeadSettings
from msss_graphslam.micron.stages import HeadState
from msss_graphslam.nodes.driving.line import FileDriver, advice_for
from msss_graphslam.nodes.driving.line_health import LineHealth
from msss_graphslam.ros.diagnostics import Finding, Level


@dataclass
class StandIn(HeadDriver):
    """A head in any state; asked for nothing else."""

    place: HeadState = HeadState.SCANNING
    skipped: int = 0
    counts: Counter[str] = field(default_factory=Counter)

    def __post_init__(self) -> None:
        super().__init__(HeadSettings(Micron()))

    @property
    def state(self) -> HeadState:
        return self.place

    @property
    def status(self) -> Any:
        return SimpleNamespace(
            period=0.04,
            skipped_bytes=self.skipped,
            counts=self.counts.copy(),
            restarts=Counter(),
            version=None,
            beams_a_request=2,
        )


class Scene:
    """A line, a head and a clock, all in the test's hands."""

    def __init__(self) -> None:
        self.now = 1000.0
        self.head = StandIn()
        self.link: Any = SimpleNamespace(
            is_open=True, ended=False, error="", openings=1, failures=0
        )
        self.pings: Any = SimpleNamespace(silence=0.0)
        self.health = LineHealth(self.link, self.pings, lambda: self.now)
        self.health.opened(self.head)

    def found(self) -> Finding | None:
        return self.health.finding(self.head)

    def after(self, seconds: float, received: int = 0) -> Finding | None:
        self.now += seconds
        self.health.received(received)
        return self.found()


@pytest.fixture
def scene() -> Scene:
    return Scene()


def test_a_head_that_scans_is_well(scene: Scene) -> None:
    assert scene.after(1.0, 500) is None


@pytest.mark.parametrize(
    ("error", "advice"),
    [
        ("serial port /dev/ttyUSB0: it is not there", "adapter plugged in"),
        ("serial port /dev/ttyUSB0: not permitted: its group", "usermod -aG dialout"),
        ("serial port /dev/ttyUSB0: another program uses it", "ModemManager"),
        ("serial server h, port 1: [Errno 111] Connection refused", "serial server run"),
        ("serial server h, port 1: timed out", "host its address"),
        ("serial server h, port 1: [Errno -2] Name or service not known", "host must be"),
        ("file .: it is not there, or no file", "file must name one"),
        ("something nobody has seen", ""),
    ],
)
def test_a_line_that_does_not_open_comes_with_advice(
    scene: Scene, error: str, advice: str
) -> None:
    scene.link.is_open, scene.link.error = False, error
    found = scene.found()
    assert found is not None
    assert found.level is Level.ERROR
    assert found.text.startswith(error)
    assert found.text.endswith("it is tried again")
    assert advice in found.text
    assert advice_for(error) in found.text


@pytest.mark.parametrize(("silence", "level"), [(5.0, None), (5.1, Level.ERROR)])
def test_a_line_without_a_byte(scene: Scene, silence: float, level: Level | None) -> None:
    found = scene.after(silence)
    assert (found and found.level) == level
    if found:
        assert "nothing comes from the head for 5 s" in found.text


@pytest.mark.parametrize(
    ("received", "skipped", "told"),
    [(200, 200, False), (201, 201, True), (1000, 900, False), (1000, 901, True), (1000, 0, False)],
)
def test_bytes_that_are_no_packets(scene: Scene, received: int, skipped: int, told: bool) -> None:
    scene.head.skipped = skipped
    found = scene.after(1.0, received)
    assert (found is not None) == told
    if found:
        assert "is baudrate right" in found.text


def test_bytes_skipped_on_an_earlier_line_do_not_count(scene: Scene) -> None:
    scene.head.skipped = 5000
    scene.health.opened(scene.head)
    assert scene.after(1.0, 500) is None


@pytest.mark.parametrize(("silence", "level"), [(2.0, None), (2.1, Level.ERROR)])
def test_a_head_that_scans_but_sends_no_beam(
    scene: Scene, silence: float, level: Level | None
) -> None:
    scene.after(4.0, 100)
    scene.pings.silence = silence
    found = scene.found()
    assert (found and found.level) == level


def test_a_line_that_has_just_opened_is_given_time(scene: Scene) -> None:
    scene.pings.silence = 100.0
    assert scene.after(1.0, 10) is None


@pytest.mark.parametrize(("waited", "level"), [(44.0, Level.WARN), (46.0, Level.ERROR)])
def test_a_head_that_does_not_come_to_scan(scene: Scene, waited: float, level: Level) -> None:
    scene.head.place = HeadState.CENTRING
    found = None
    for _ in range(int(waited)):
        found = scene.after(1.0, 22)
    assert found is not None
    assert (found.level, found.text) == (level, f"head: centring, not scanning for {waited:g} s")


@pytest.mark.parametrize("event", ["resets", "motor_errors", "timeouts", "parameters_not_taken"])
def test_an_event_is_told_for_ten_seconds(scene: Scene, event: str) -> None:
    scene.head.counts[event] += 1
    found = scene.after(1.0, 100)
    assert found is not None
    assert found.level is Level.WARN
    assert scene.after(4.0, 100) is not None
    assert scene.after(4.0, 100) is not None
    assert scene.after(2.1, 100) is None


def test_the_rows_are_there_from_the_start(scene: Scene) -> None:
    rows = scene.health.rows(scene.head)
    assert rows["port"] == "open"
    assert rows["head"] == "scanning"
    assert (rows["head/resets"], rows["head/motor_errors"], rows["head/partial_turns"]) == (0,) * 3
    scene.link.is_open, scene.link.error = False, "gone"
    assert scene.health.rows(scene.head)["port"] == "gone"


def test_a_file_at_its_end_is_a_warning(scene: Scene) -> None:
    reader = FileDriver(Micron(source="file"))
    assert scene.health.finding(reader) is None
    scene.link.is_open, scene.link.ended, scene.link.error = False, True, "file f: at its end"
    found = scene.health.finding(reader)
    assert found == Finding(Level.WARN, "file f: at its end")
