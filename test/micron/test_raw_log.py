# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Recorded bytes give the beams of the live head again; what is no beam is counted."""

from dataclasses import replace

import pytest
from micron.scripted_head import START_NS, Bench, ScriptedHead

from benchmarks.micron_stream import head_data
from msss_graphslam.config.groups import Micron
from msss_graphslam.micron.head_driver import HeadDriver
from msss_graphslam.micron.packets import HeadData, HeadStatus
from msss_graphslam.micron.raw_log import RawBeams
from msss_graphslam.micron.settings import HeadSettings

BEAM = head_data(bytes(range(200)))


def raw() -> RawBeams:
    return RawBeams(1500.0, False, 115200)


def test_node_and_offline_run_see_the_same_beams() -> None:
    driver = HeadDriver(HeadSettings(Micron()))
    bench = Bench(driver, ScriptedHead(replies=2))
    pieces: list[tuple[bytes, int]] = []
    feed = bench.feed
    bench.feed = lambda data: (pieces.append((data, bench.now_ns)), feed(data))[1]  # type: ignore[method-assign]
    driver.opened(bench.now_ns)
    bench.run(7.0)
    bench.head.restart(bench.now_ns)
    bench.run(8.0)
    again = raw()
    beams = [beam for data, at in pieces for beam in again.feed(data, at)]
    live = [beam for _, beam in bench.beams]
    assert len(live) > 100
    assert [(b.stamp_ns, b.bearing) for b in beams] == [(b.stamp_ns, b.bearing) for b in live]


def test_a_beam_sent_twice_is_one() -> None:
    beams, packet = raw(), BEAM.frame().encode()
    assert len(beams.feed(packet + packet, START_NS)) == 1
    assert beams.refused["beam sent twice"] == 1
    assert len(beams.feed(packet, START_NS + 1_000_000_000)) == 1
    other = replace(BEAM, bearing=BEAM.bearing + BEAM.step).frame().encode()
    assert len(beams.feed(other, START_NS + 1_000_000_000)) == 1


@pytest.mark.parametrize(
    ("packet", "reason"),
    [
        (replace(BEAM, status=HeadStatus.MOTOR_ERROR), "head has lost its bearing"),
        (replace(BEAM, status=HeadStatus.POWER_LOSS), "head has lost its parameters"),
        (replace(BEAM, ad_interval=0), "head data without bins"),
    ],
)
def test_what_is_no_beam_is_counted(packet: HeadData, reason: str) -> None:
    beams = raw()
    assert beams.feed(packet.frame().encode(), START_NS) == []
    assert beams.refused[reason] == 1


def test_a_time_before_the_clocks_start_is_refused() -> None:
    beams = raw()
    assert beams.feed(BEAM.frame().encode(), 0) == []
    assert beams.refused["beam before the clock's start"] == 1
