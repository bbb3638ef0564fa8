# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The driver fed with recorded bytes: the beams that an offline run makes of them."""

from collections.abc import Iterator

import numpy as np
import pytest
from head_bytes import PERIOD_NS, START_NS, packets
from nodes.emulated_heads import Driven, driven
from nodes.processes import wait_until

from msss_graphslam.messages import encoding, topics
from msss_graphslam.micron.raw_log import RawBeams
from msss_graphslam.ros.diagnostics import Level
from msss_graphslam.ros.messages import make

pytestmark = pytest.mark.slow


@pytest.fixture
def driver() -> Iterator[Driven]:
    with driven(source="topic") as found:
        found.offer(topics.SONAR_RAW)
        yield found


def send(driver: Driven, data: bytes, received_ns: int) -> None:
    driver.send(topics.SONAR_RAW, encoding.raw_bytes(make, data, received_ns))


def test_the_beams_are_those_of_the_decoder(driver: Driven) -> None:
    pieces = list(packets(60))
    for piece in pieces:
        send(driver, *piece)
    decoder = RawBeams(1500.0, False, 115200)
    expected = [beam for piece in pieces for beam in decoder.feed(*piece)]
    beams = driver.await_beams(60)
    for mine, theirs in zip(beams, expected, strict=True):
        assert (mine.stamp_ns, mine.bearing) == (theirs.stamp_ns, np.float32(theirs.bearing))
        np.testing.assert_array_equal(mine.intensities, theirs.intensities)
    assert driver.test.node.count_publishers("sonar/raw") == 1


def test_a_save_waits_for_what_is_under_way(driver: Driven) -> None:
    for piece in packets(200):
        send(driver, *piece)
    wait_until(lambda: driver.trigger("save").success, "the save")
    assert len(driver.await_beams(200)) == 200
    told = "200 beams published"
    wait_until(lambda: told in driver.trigger("save").message, "what the save tells")


def test_bytes_without_a_time_get_that_of_the_clock(driver: Driven) -> None:
    message = encoding.raw_bytes(make, next(packets(1))[0], START_NS)
    message.layout.dim = []
    driver.send(topics.SONAR_RAW, message)
    (beam,) = driver.await_beams(1)
    now_ns = driver.test.node.get_clock().now().nanoseconds
    assert 0 < now_ns - beam.stamp_ns < 60 * 10**9


def test_what_is_no_message_or_no_packet_is_refused(driver: Driven) -> None:
    broken = encoding.raw_bytes(make, b"@", START_NS)
    broken.layout.dim[0].label = "received -1"
    driver.send(topics.SONAR_RAW, broken)
    pieces = list(packets(3))
    send(driver, b"\xff" * 50 + pieces[0][0], pieces[0][1])
    send(driver, pieces[1][0][:20] + pieces[2][0], pieces[2][1])
    driver.await_beams(2)
    driver.await_row("refused/raw_label_invalid", "1")
    wait_until(lambda: int(driver.diagnostic("skipped_bytes")) >= 70, "skipped bytes")
    assert driver.await_text("refused [0-9]+ in the last 10 s") >= Level.WARN
    assert driver.process.is_running


def test_a_second_turn_of_time_needs_a_reset_only_for_the_stamps(driver: Driven) -> None:
    """After a reset the same bytes give the same beams: a replay may begin anew."""
    for piece in packets(20):
        send(driver, *piece)
    first = driver.await_beams(20)
    assert driver.trigger("reset").success
    for piece in packets(20):
        send(driver, *piece)
    second = driver.await_beams(40)[20:]
    assert [beam.stamp_ns for beam in second] == [beam.stamp_ns for beam in first]


def test_parameters_of_the_decoding_change_at_run_time(driver: Driven) -> None:
    pieces = list(packets(40))
    for piece in pieces[:20]:
        send(driver, *piece)
    plain = driver.await_beams(20)[-1]
    assert driver.set(sound_speed=1530.0).successful
    for piece in pieces[20:]:
        send(driver, *piece)
    fast = driver.await_beams(40)[-1]
    assert fast.ranges[-1] == pytest.approx(1.02 * plain.ranges[-1], rel=1e-5)
    assert fast.stamp_ns - plain.stamp_ns == pytest.approx(20 * PERIOD_NS, abs=2e6)


def test_silence_is_an_error(driver: Driven) -> None:
    assert driver.await_text("no input on sonar/raw for") == Level.ERROR
