# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The faults that are ordered happen, no others, and the driver gets over each of them."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from emulated_head import SECOND, START_NS, Pattern, command

from msss_graphslam.config.groups.micron import Micron
from msss_graphslam.core.types import Beam
from msss_graphslam.errors import UserError
from msss_graphslam.micron.head_driver import HeadDriver
from msss_graphslam.micron.settings import HeadSettings
from msss_graphslam.micron.stages import HeadState
from msss_graphslam.simulation.emulator.emulator import Emulator
from msss_graphslam.simulation.emulator.faults import Faults, Noise, Span
from msss_graphslam.simulation.emulator.head import Head
from msss_graphslam.simulation.emulator.scanner import Nature

PACKET = command().frame().encode()
PARAMETERS = Micron(range_m=10.0, bins=200)


@dataclass
class Talk:
    """What came of a driver's talk with an emulator."""

    driver: HeadDriver
    pieces: list[tuple[float, bytes]]
    beams: list[tuple[float, Beam]]
    pings: list[tuple[float, float]]

    def gaps(self, least: float = 0.5) -> list[tuple[float, float]]:
        """The time spans without beams [s]."""
        arrivals = [at for at, _ in self.beams]
        return [(a, b) for a, b in pairwise(arrivals) if b - a > least]


def talk(
    seconds: float,
    faults: Faults | None = None,
    nature: Nature | None = None,
    parameters: Micron = PARAMETERS,
) -> Talk:
    """Let a driver scan with an emulated head for a while, without a port or a clock."""
    look = Pattern()
    emulator = Emulator(Head(look, nature or Nature(), START_NS), faults or Faults(), 7, START_NS)
    driver = HeadDriver(HeadSettings(parameters))
    talk = Talk(driver, [], [], look.pings)
    now, plugged = START_NS, False
    while now < START_NS + seconds * SECOND:
        if emulator.plugged(now) is not plugged:
            plugged = not plugged
            (driver.opened if plugged else driver.closed)(now)
        for data in driver.due(now):
            emulator.receive(data, now)
        for piece in emulator.due(now):
            at = (now - START_NS) / SECOND
            talk.pieces.append((at, piece))
            talk.beams += [(at, beam) for beam in driver.feed(piece, now)]
        times = [at for at in (emulator.next_ns, driver.next_ns) if at is not None]
        now = max(min(times), now + 50_000)
    return talk


@pytest.mark.parametrize(
    "nature", [Nature(), Nature(full_duplex=False), Nature(seaking=True), Nature(fewer_bins=3)]
)
def test_without_faults_every_beam_arrives_with_its_time_and_bearing(nature: Nature) -> None:
    done = talk(20.0, nature=nature)
    assert len(done.beams) > 350
    assert not done.driver.status.refused
    times = [bearing_and_time[1] for bearing_and_time in done.pings]
    for (_, beam), (bearing, time) in zip(done.beams, done.pings, strict=False):
        assert np.angle(np.exp(1j * (beam.bearing - bearing))) == pytest.approx(0.0, abs=1e-9)
        assert abs(beam.stamp_ns - START_NS - time * SECOND) < 5e6
    assert np.diff(times)[5:].max() < 0.05


@pytest.mark.parametrize("bits", [8, 4])
def test_the_head_does_what_the_driver_asks_for(bits: int) -> None:
    parameters = replace(
        PARAMETERS, step_deg=3.6, sector_deg=90.0, sector_centre_deg=45.0, data_bits=bits
    )
    done = talk(15.0, parameters=parameters)
    assert done.driver.state is HeadState.SCANNING
    assert len(done.beams) > 100
    bearings = np.degrees([beam.bearing for _, beam in done.beams])
    assert bearings.min() == pytest.approx(0.0, abs=0.06)
    assert bearings.max() == pytest.approx(90.0, abs=0.06)
    assert {len(beam.ranges) for _, beam in done.beams} == {200}
    assert abs(done.beams[0][1].ranges[-1] - 10.0) < 0.1


def test_pieces_put_together_are_the_packets() -> None:
    whole, split = talk(8.0), talk(8.0, Faults(split=7))
    sizes = {len(piece) for _, piece in split.pieces}
    assert sizes == set(range(1, 8))
    ends = b"".join(piece for _, piece in whole.pieces)
    assert b"".join(piece for _, piece in split.pieces)[: len(ends) - 2000] == ends[:-2000]
    assert [at for at, _ in split.pieces] == sorted(at for at, _ in split.pieces)
    assert len(split.beams) == pytest.approx(len(whole.beams), abs=3)


def test_garbage_comes_before_packets_and_does_not_touch_them() -> None:
    noise = Noise(Faults(garbage=0.3), 1, "out")
    arrived = [noise.on(PACKET) for _ in range(2000)]
    assert all(one.endswith(PACKET) for one in arrived)
    assert np.mean([len(one) > len(PACKET) for one in arrived]) == pytest.approx(0.3, abs=0.04)
    assert max(len(one) for one in arrived) <= len(PACKET) + 60


def test_bytes_get_lost_at_the_rate_ordered() -> None:
    noise = Noise(Faults(lost=0.02), 1, "out")
    arrived = sum(len(noise.on(PACKET)) for _ in range(2000)) / (2000 * len(PACKET))
    assert arrived == pytest.approx(0.98, abs=0.002)


def test_one_bit_of_a_byte_flips_at_the_rate_ordered() -> None:
    noise = Noise(Faults(flipped=0.02), 1, "out")
    sent = np.frombuffer(PACKET, dtype=np.uint8)
    errors = np.array([sent ^ np.frombuffer(noise.on(PACKET), np.uint8) for _ in range(2000)])
    assert np.mean(errors != 0) == pytest.approx(0.02, abs=0.002)
    assert set(np.unique(errors).tolist()) == {0, *(1 << bit for bit in range(8))}


def test_the_same_seed_gives_the_same_faults() -> None:
    faults = Faults(garbage=0.1, lost=0.001, flipped=0.001, split=50)
    first, again = talk(6.0, faults), talk(6.0, faults)
    assert first.pieces == again.pieces
    other = Noise(faults, 8, "to the host")
    same = Noise(faults, 7, "to the host")
    assert [other.on(PACKET) for _ in range(50)] != [same.on(PACKET) for _ in range(50)]


@pytest.mark.parametrize(
    ("faults", "share"),
    [
        (Faults(garbage=0.2, split=40), 0.9),
        (Faults(lost=1e-4), 0.85),
        (Faults(flipped=1e-4), 0.85),
        (Faults(lost=1e-3, flipped=1e-3, garbage=0.05, split=11), 0.1),
    ],
)
def test_a_bad_line_costs_beams_but_brings_no_false_bearing(faults: Faults, share: float) -> None:
    done, clean = talk(40.0, faults), talk(40.0)
    assert share * len(clean.beams) <= len(done.beams) <= len(clean.beams)
    looked = {round(np.degrees(bearing), 3) % 360.0 for bearing, _ in done.pings}
    seen = [round(np.degrees(beam.bearing), 3) % 360.0 for _, beam in done.beams]
    assert np.mean([bearing in looked for bearing in seen]) > 0.99


def test_a_reset_in_mid_turn_costs_no_more_than_the_start() -> None:
    done = talk(30.0, Faults(resets=(10.0, 20.0)))
    assert done.driver.status.counts["resets"] == 2
    gaps = done.gaps()
    assert [start for start, _ in gaps] == pytest.approx([10.0, 20.0], abs=0.2)
    ready = 2.5  # the first alive after the head has found its centre
    assert all(end - (at + ready) < 3.0 for (_, end), at in zip(gaps, (10.0, 20.0), strict=True))


def test_a_packet_that_a_reset_cuts_never_ends() -> None:
    times = [at for at, _ in talk(8.0, Faults(split=1)).pieces]
    amid = next(i for i, at in enumerate(times) if at > 7.0 and times[i + 20] - at < 0.01)
    reset = times[amid + 10] + 1e-6
    pieces = talk(8.0, Faults(resets=(reset,), split=1)).pieces
    assert pieces[amid + 10][0] == pytest.approx(reset, abs=1e-4)
    assert pieces[amid + 11][0] >= reset + 0.5


def test_a_motor_error_is_followed_by_new_parameters() -> None:
    done = talk(20.0, Faults(motor_errors=(10.0,)))
    assert done.driver.status.counts["motor_errors"] >= 1
    (gap,) = done.gaps()
    assert gap[0] == pytest.approx(10.0, abs=0.2)
    assert gap[1] < 13.0


def test_a_silent_head_is_asked_again() -> None:
    done = talk(20.0, Faults(silences=(Span(10.0, 3.0),)))
    assert not [at for at, _ in done.pieces if 10.0 <= at < 13.0]
    (gap,) = done.gaps()
    assert gap[0] == pytest.approx(10.0, abs=0.1)
    assert gap[1] < 13.0 + 3.0


def test_a_head_that_is_plugged_in_again_scans_on() -> None:
    done = talk(40.0, Faults(unplugged=(Span(10.0, 20.0),)))
    assert not [at for at, _ in done.pieces if 10.0 <= at < 30.0]
    (gap,) = done.gaps()
    assert gap[1] < 30.0 + 6.0


@pytest.mark.parametrize(
    "make",
    [
        lambda: Faults(garbage=1.1),
        lambda: Faults(lost=-0.1),
        lambda: Faults(flipped=float("nan")),
        lambda: Faults(split=-1),
        lambda: Span(-1.0, 1.0),
        lambda: Span(1.0, 0.0),
        lambda: Span(float("nan"), 1.0),
    ],
)
def test_faults_without_sense_are_refused(make: Callable[[], Any]) -> None:
    with pytest.raises(UserError):
        make()


def test_shares_may_be_nothing_or_all() -> None:
    assert Noise(Faults(lost=1.0), 1, "out").on(PACKET) == b""
    assert Noise(Faults(lost=0.0, flipped=0.0), 1, "out").on(PACKET) == PACKET
    assert Noise(Faults(lost=1.0), 1, "out").pieces(b"") == []
