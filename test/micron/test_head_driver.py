# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""A live head as one object."""

from dataclasses import replace

from micron.scripted_head import Bench, ScriptedHead

from msss_graphslam.config.groups import Micron
from msss_graphslam.micron.head_driver import HeadDriver
from msss_graphslam.micron.settings import HeadSettings
from msss_graphslam.micron.stages import HeadState


def test_beams_in_any_chunks_while_parameters_change() -> None:
    bench = Bench(HeadDriver(HeadSettings(Micron())), ScriptedHead())
    whole = bench.feed
    bench.feed = lambda data: [whole(data[i : i + 7]) for i in range(0, len(data), 7)]  # type: ignore
    bench.driver.opened(bench.now_ns)
    bench.run(7.0)
    assert bench.beams[-1][1].ranges[-1] < 20.1
    slower = replace(Micron(), sound_speed=1450.0, inverted=True)
    bench.driver.configure(HeadSettings(slower))
    bench.run(3.0)
    status = bench.driver.status
    assert status.state is HeadState.SCANNING
    assert status.version is not None
    assert status.version.serial == 7
    assert status.skipped_bytes == 0
    assert 0.03 < status.period < 0.06


def test_half_a_packet_before_a_cut_does_not_spoil_the_next() -> None:
    bench = Bench(HeadDriver(HeadSettings(Micron())), ScriptedHead())
    bench.driver.opened(bench.now_ns)
    bench.run(7.0)
    beams = len(bench.beams)
    bench.feed(bench.head.beam().frame().encode()[:100])
    bench.driver.closed(bench.now_ns)
    bench.driver.opened(bench.now_ns)
    bench.feed(bench.head.beam().frame().encode())
    assert len(bench.beams) == beams + 1
    assert bench.driver.status.skipped_bytes == 100
