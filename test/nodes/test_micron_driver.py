# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The driver as a process at an emulated head: beams, faults of the line, other settings."""

from pathlib import Path

import numpy as np
import pytest
from head_bytes import packets
from nodes.emulated_heads import driven, emulated
from nodes.fed_nodes import DIAGNOSTICS
from nodes.processes import domain, wait_until

from msss_graphslam.messages import decoding, topics
from msss_graphslam.micron.raw_log import RawBeams
from msss_graphslam.micron.timing import STEP_ANGLE
from msss_graphslam.ros.diagnostics import Level
from msss_graphslam.ros.messages import message_class

pytestmark = pytest.mark.slow

SET_BOOL = message_class("std_srvs/srv/SetBool")
STEP = 32 * STEP_ANGLE


def test_a_head_at_a_serial_port_is_heard_beam_by_beam(tmp_path: Path) -> None:
    port = tmp_path / "head"
    with domain() as own, emulated(own, "--pty", port), driven(own=own, port=port) as driver:
        driver.hear(topics.SONAR_RAW)
        beams = driver.await_beams(40)
        scan = driver.heard(topics.SONAR_PING)[20]
        assert scan.header.frame_id == "sonar_link"
        assert scan.scan_time == pytest.approx(0.0427, rel=0.1)
        assert {len(beam.ranges) for beam in beams} == {350}
        assert beams[0].ranges[-1] == pytest.approx(20.0 - 0.5 * 20.0 / 350, rel=0.01)
        turned = np.unwrap([beam.bearing for beam in beams])
        np.testing.assert_allclose(np.diff(turned), -STEP, atol=1e-5)
        assert (np.diff([beam.stamp_ns for beam in beams]) > 0).all()
        driver.await_row("head", "scanning")
        assert driver.await_text("^running$") == Level.OK
        assert (driver.diagnostic("port"), driver.diagnostic("port/openings")) == ("open", "1")


def test_the_bytes_that_go_out_give_the_same_beams(tmp_path: Path) -> None:
    """What is recorded of a dive is what the dive was: same numbers, same stamps."""
    port = tmp_path / "head"
    with domain() as own, driven(own=own, port=port) as driver:
        driver.hear(topics.SONAR_RAW)
        with emulated(own, "--pty", port, "--split", 90):
            driver.await_beams(30)
    decoder = RawBeams(1500.0, False, 115200)
    pieces = map(decoding.raw_bytes, driver.heard(topics.SONAR_RAW))
    again = [beam for piece in pieces for beam in decoder.feed(piece.data, piece.received_ns)]
    for mine, theirs in zip(driver.beams, again, strict=False):
        assert mine.stamp_ns == theirs.stamp_ns
        np.testing.assert_array_equal(mine.intensities, theirs.intensities)
        np.testing.assert_array_equal(mine.ranges, theirs.ranges.astype(np.float32))
    assert len(again) >= 30


def test_a_head_behind_a_serial_server() -> None:
    with domain() as own, emulated(own, "--tcp", 0, "--duplex", "half") as emulator:
        number = emulator.wait_for_output(r"127\.0\.0\.1:\d+").rpartition(":")[2]
        parameters = {"source": "tcp", "host": "127.0.0.1", "tcp_port": number}
        with driven(own=own, **parameters) as driver:
            driver.await_beams(10)
            driver.await_row("source", "tcp")


def test_without_a_port_there_is_an_error_and_never_a_beam(tmp_path: Path) -> None:
    port = tmp_path / "head"
    with domain() as own, driven(own=own, port=port) as driver:
        assert driver.await_text("is not there; is the adapter plugged in") == Level.ERROR
        wait_until(lambda: int(driver.diagnostic("port/failures")) >= 2, "another attempt")
        assert driver.heard(topics.SONAR_PING) == []
        with emulated(own, "--pty", port):
            driver.await_beams(3)
        assert driver.await_text("serial port .*head: ") == Level.ERROR
        assert driver.process.interrupt() == 0


def test_range_and_step_change_between_two_beams(tmp_path: Path) -> None:
    port = tmp_path / "head"
    with domain() as own, emulated(own, "--pty", port), driven(own=own, port=port) as driver:
        driver.await_beams(5)
        assert driver.set(range_m=10.0, bins=200, step_deg=3.6).successful
        wait_until(lambda: len(driver.beams[-1].ranges) == 200, "beams of 200 bins")
        beams = driver.await_more(10)
        assert {len(beam.ranges) for beam in beams} == {200}
        assert beams[-1].ranges[-1] == pytest.approx(10.0 - 0.025, rel=0.01)
        np.testing.assert_allclose(
            np.diff(np.unwrap([beam.bearing for beam in beams])), -2.0 * STEP, atol=1e-5
        )
        assert driver.diagnostic("port/openings") == "1"
        assert driver.set(frame_id="head").successful
        driver.await_more(3)
        assert driver.heard(topics.SONAR_PING)[-1].header.frame_id == "head"


@pytest.mark.parametrize(
    ("values", "reason"),
    [
        ({"range_m": 0.1}, "range"),
        ({"source": "usb"}, "must be one of serial, tcp, topic, file"),
        ({"range_m": 0.5, "bins": 800}, "at 0.5 m the head gives at most"),
        ({"gain": "high"}, "type"),
    ],
)
def test_what_no_head_can_do_is_refused_with_the_reason(
    values: dict[str, object], reason: str
) -> None:
    with driven(source="topic") as driver:
        result = driver.set(**values)
        assert not result.successful
        assert reason in result.reason


def test_a_start_with_values_that_do_not_go_together_is_told() -> None:
    with driven(source="topic", range_m=0.5, bins=800) as driver:
        text = "at most 208; range 20 m, 350 bins are used"
        assert driver.await_text(text.replace("208", r"\d+")) == Level.ERROR


def test_a_file_is_played_and_its_end_is_told(tmp_path: Path) -> None:
    file = tmp_path / "head.bin"
    file.write_bytes(b"noise" + b"".join(data for data, _ in packets(150)))
    with driven(source="file", file=file) as driver:
        driver.hear(topics.SONAR_RAW)
        assert driver.await_text("it is at its end") == Level.WARN
        beams = driver.beams
        assert 0 < len(beams) <= 150
        assert int(driver.diagnostic("beams")) == 150
        intervals = np.diff([beam.stamp_ns for beam in beams]) * 1e-9
        assert np.median(intervals) == pytest.approx(0.0427, rel=0.1)
        file.unlink()
        assert driver.set(file=str(tmp_path / "none")).successful
        assert driver.await_text("must name one") == Level.ERROR


def test_another_port_is_opened_at_run_time(tmp_path: Path) -> None:
    one, other = tmp_path / "one", tmp_path / "other"
    with domain() as own, driven(own=own, port=one) as driver, emulated(own, "--pty", one):
        driver.await_beams(3)
        with emulated(own, "--pty", other, "--seed", 2):
            assert driver.set(port=str(other)).successful
            driver.await_row("port/openings", "1")
            driver.await_more(3)
            assert driver.set(source="topic").successful
            wait_until(
                lambda: driver.test.node.count_publishers("sonar/raw") == 0, "no raw publisher"
            )
            assert driver.test.node.count_subscribers("sonar/raw") == 1
            assert driver.set(source="serial").successful
            driver.await_more(3)
            wait_until(lambda: driver.test.node.count_subscribers("sonar/raw") == 0, "no ear")


def test_noise_on_the_line_is_counted_and_the_beams_go_on(tmp_path: Path) -> None:
    port = tmp_path / "head"
    faults = ("--garbage", "0.2", "--lost", "2e-4", "--flipped", "2e-4")
    with domain() as own, emulated(own, "--pty", port, *faults), driven(own=own, port=port) as d:
        d.await_beams(60)
        wait_until(lambda: int(d.diagnostic("skipped_bytes") or 0) > 0, "skipped bytes")
        assert d.await_text("refused [0-9]+ in the last 10 s") == Level.WARN
        rows = {e.key for e in d.heard(DIAGNOSTICS)[-1].status[0].values}
        assert any(key.startswith("refused/") for key in rows)
        assert not any(" " in key for key in rows)
        assert d.diagnostic("refused/internal_error") == ""


def test_a_pause_drops_beams_and_counts_them(tmp_path: Path) -> None:
    port = tmp_path / "head"
    with domain() as own, emulated(own, "--pty", port), driven(own=own, port=port) as driver:
        driver.await_beams(3)
        assert driver.test.call(SET_BOOL, "/micron_driver/pause", data=True).success
        wait_until(lambda: int(driver.diagnostic("refused/paused") or 0) > 5, "dropped beams")
        before = len(driver.beams)
        wait_until(lambda: int(driver.diagnostic("refused/paused")) > 30, "more of them")
        assert len(driver.beams) <= before + 1
        assert driver.test.call(SET_BOOL, "/micron_driver/pause", data=False).success
        driver.await_more(3)
