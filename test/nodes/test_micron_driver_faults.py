# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The driver at an emulated head that starts anew, falls silent, or loses its cable."""

from contextlib import ExitStack
from itertools import pairwise
from pathlib import Path

import pytest
from nodes.emulated_heads import driven, emulated
from nodes.processes import domain, wait_until

from msss_graphslam.core.types import Beam
from msss_graphslam.messages import topics
from msss_graphslam.ros.diagnostics import Level
from msss_graphslam.simulation.emulator.waking import ALIVE_PERIOD, CENTRING

pytestmark = pytest.mark.slow

UNPLUGGED = 20.0


def longest_gap(beams: list[Beam]) -> float:
    """Return the longest time between two beams [s]."""
    return max(after.stamp_ns - before.stamp_ns for before, after in pairwise(beams)) * 1e-9


def test_f5_a_reset_in_mid_turn_costs_a_turn_and_is_counted(tmp_path: Path) -> None:
    """Within 3 s of the head being ready it scans again."""
    port = tmp_path / "head"
    with domain() as own, driven(own=own, port=port) as driver:
        with emulated(own, "--pty", port, "--reset", 10):
            driver.await_beams(20)
            driver.await_row("head/resets", "1")
            assert driver.diagnostic("head/partial_turns") == "1"
            beams = driver.await_more(20)
            assert driver.diagnostic("head/rebooting") == "1"
            assert longest_gap(driver.beams) < CENTRING + ALIVE_PERIOD + 3.0
            assert len(beams) == 20
        assert driver.await_text("serial port") == Level.ERROR


def test_f7_after_20_s_without_the_cable_beams_come_within_6_s(tmp_path: Path) -> None:
    port = tmp_path / "head"
    with (
        domain() as own,
        emulated(own, "--pty", port, "--unplug", f"9:{UNPLUGGED}"),
        driven(own=own, port=port) as driver,
    ):
        driver.await_beams(20)
        assert driver.await_text("serial port .*: .*tried again") == Level.ERROR
        before = len(driver.beams)
        driver.await_row("port/openings", "2")
        driver.await_beams(before + 20)
        gap = longest_gap(driver.beams)
        assert UNPLUGGED - 0.5 < gap < UNPLUGGED + 6.0
        assert driver.process.is_running
        assert driver.await_text("^running$") == Level.OK


def test_a_motor_that_has_lost_its_bearing_gets_its_parameters_anew(tmp_path: Path) -> None:
    port = tmp_path / "head"
    with (
        domain() as own,
        emulated(own, "--pty", port, "--motor-error", 9),
        driven(own=own, port=port) as driver,
    ):
        driver.await_row("head/motor_errors", "1")
        assert driver.await_text("lost its bearing") == Level.WARN
        driver.await_more(20)
        assert driver.diagnostic("head/configuring") == "2"
        assert longest_gap(driver.beams) < 6.0


def test_a_head_that_falls_silent_is_told_of_and_asked_again(tmp_path: Path) -> None:
    port = tmp_path / "head"
    with (
        domain() as own,
        emulated(own, "--pty", port, "--silence", "9:8"),
        driven(own=own, port=port) as driver,
    ):
        driver.await_beams(5)
        assert driver.await_text("nothing comes from the head for .* wires") == Level.ERROR
        before = len(driver.beams)
        driver.await_beams(before + 20)
        wait_until(lambda: int(driver.diagnostic("head/timeouts")) > 0, "timeouts")


def test_the_server_of_a_head_that_goes_away_comes_back() -> None:
    with domain() as own, emulated(own, "--tcp", 0, "--unplug", "9:4") as emulator:
        number = emulator.wait_for_output(r"127\.0\.0\.1:\d+").rpartition(":")[2]
        with driven(own=own, source="tcp", host="127.0.0.1", tcp_port=number) as driver:
            driver.await_beams(5)
            assert driver.await_text("serial server 127.0.0.1, port") == Level.ERROR
            driver.await_row("port/openings", "2")
            driver.await_more(10)


def test_beams_become_poses_and_scans(tmp_path: Path) -> None:
    """From the head's bytes to the corrected pose, without anything else."""
    port = tmp_path / "head"
    nodes = ("dead_reckoning", "scan_generation", "front_end", "back_end")
    with (
        domain() as own,
        driven(own=own, port=port, step_deg=3.6, range_m=15.0) as driver,
        ExitStack() as stack,
    ):
        for name in nodes:
            stack.enter_context(own.start(name))
        for topic in (topics.POSE, topics.SCAN, topics.KEYFRAMES):
            driver.hear(topic)
        stack.enter_context(emulated(own, "--pty", port, "--world", "pond"))
        wait_until(lambda: len(driver.heard(topics.SCAN)) >= 2, "two scans", 90.0)
        wait_until(lambda: driver.heard(topics.KEYFRAMES), "a keyframe", 30.0)
        assert driver.heard(topics.POSE)
        assert driver.heard(topics.SCAN)[-1].width > 20
