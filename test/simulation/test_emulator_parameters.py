# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What parameters the emulated head takes, and that it works by them."""

from typing import Any

import numpy as np
import pytest
from emulated_head import FULL_TURN, SECOND, START_NS, Host, command

from msss_graphslam.micron.packets import (
    Gains,
    GainsCommand,
    HeadControl,
    HeadStatus,
    ReverseScan,
    SendData,
    SendUserData,
    SendVersion,
    VersionData,
)
from msss_graphslam.simulation.emulator.scanner import Nature

HALF = Nature(full_duplex=False)


@pytest.mark.parametrize(
    "changes",
    [
        {"bins": 0},
        {"step": 0},
        {"ad_interval": 0},
        {"left_limit": 6400},
        {"right_limit": 65535},
        {"bins": 800, "ad_interval": 782},
        {"bins": 1, "control": FULL_TURN & ~HeadControl.EIGHT_BIT},
    ],
)
def test_parameters_without_sense_are_not_taken(changes: dict[str, Any]) -> None:
    host = Host().set_up(**changes)
    assert host.head.ignored == {"parameters without sense": 1}
    assert host.alives[-1][1] == 0x4A
    assert host.look.tuned == []


@pytest.mark.parametrize(
    ("changes", "bins"),
    [
        ({"bins": 1}, 1),
        ({"bins": 800, "ad_interval": 781}, 800),
        ({"bins": 1500, "ad_interval": 20}, 800),
        ({"left_limit": 6399, "right_limit": 6399}, 200),
        ({"bins": 3, "control": FULL_TURN & ~HeadControl.EIGHT_BIT}, 2),
    ],
)
def test_parameters_at_the_edge_are_taken(changes: dict[str, Any], bins: int) -> None:
    (beam,) = Host().set_up(**changes).scan(1)
    assert beam.bins == bins


def test_a_reply_repeats_the_parameters() -> None:
    host = Host(Nature(fewer_bins=4)).set_up(bins=400, ad_interval=52, range_scale=77)
    (beam,) = host.scan(1)
    assert (beam.device_type, beam.bins, beam.ad_interval) == (0x11, 396, 52)
    assert (beam.range_scale, beam.gain, beam.ad_span, beam.ad_low) == (77, 84, 81, 8)
    assert beam.status == HeadStatus.EIGHT_BIT_DATA
    assert host.look.tuned == [(pytest.approx(396 * 52 * 640e-9), 396, pytest.approx(np.pi / 100))]
    np.testing.assert_array_equal(np.frombuffer(beam.data, np.uint8), (1 + np.arange(396)) % 256)


def test_the_older_head_calls_itself_two() -> None:
    (beam,) = Host(Nature(seaking=True)).set_up().scan(1)
    assert beam.device_type == 2


def test_new_parameters_hold_from_the_next_ping_on() -> None:
    host = Host().set_up()
    last = host.scan(5)[-1]
    host.send(command(bins=100, ad_interval=50, step=64))
    host.wait(1.5)
    beams = host.scan(3)
    assert {beam.bins for beam in beams} == {100}
    assert np.diff([beam.bearing for beam in beams]).tolist() == [64, 64]
    assert (beams[0].bearing - last.bearing) % 32 == 0


def test_the_direction_and_the_gain_change_by_short_commands() -> None:
    host = Host(HALF).set_up()
    before = host.scan(1)[0]
    host.send(ReverseScan(), GainsCommand(_gains(gain_1=7)))
    after = host.scan(2)
    assert (before.gain, after[0].gain) == (84, 7)
    assert after[1].bearing - after[0].bearing == -32
    assert HeadControl.SCAN_RIGHT not in after[0].control


def test_short_commands_before_the_parameters_are_not_taken() -> None:
    host = Host()
    host.wait_until(3.0)
    host.send(ReverseScan(), GainsCommand(_gains()))
    assert host.head.ignored == {"parameters without sense": 2}


def test_a_motor_out_of_step_is_told_until_new_parameters_come() -> None:
    host = Host().set_up()
    host.scan(2)
    host.head.lose_sync()
    host.wait(0.5)
    assert all(HeadStatus.MOTOR_ERROR in beam.status for beam in host.scan(3))
    host.send(command())
    assert HeadStatus.MOTOR_ERROR not in host.scan(3)[-1].status


def test_bytes_at_random_neither_stop_nor_deafen_it() -> None:
    host = Host()
    host.wait_until(3.0)
    generator = np.random.default_rng(5)
    for _ in range(300):
        noise = generator.bytes(int(generator.integers(1, 200)))
        damaged = bytearray(command().frame().encode())
        damaged[int(generator.integers(len(damaged)))] ^= 1 << int(generator.integers(8))
        for data in (noise, bytes(damaged)):
            host.head.receive(data, START_NS + round(host.time * SECOND))
        host.send(SendData(), SendUserData())
        host.wait(0.01)
    host.wait(5.0)
    host.send(SendVersion())
    host.wait(0.1)
    assert host.of(VersionData)


def _gains(gain_1: int = 84) -> Gains:
    return Gains(ad_span_1=81, ad_span_2=81, ad_low_1=8, ad_low_2=8, gain_1=gain_1, gain_2=84)
