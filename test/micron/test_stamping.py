# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Times of transmission from late receipts."""

from dataclasses import replace

import numpy as np
import pytest
from micron.recorded_packets import UDP_LOG, needed

from benchmarks.micron_stream import head_data
from msss_graphslam.micron.framing import Framer
from msss_graphslam.micron.packets import HeadData, decode_packet
from msss_graphslam.micron.stamping import TransmitClock
from msss_graphslam.micron.timing import reply_delay

START_NS = 1_750_000_000_000_000_000
MS = 1_000_000
PERIOD = 42.66 * MS


def beam(number: int) -> HeadData:
    ten_metres = replace(head_data(bytes(200)), ad_interval=104, step=32)
    return replace(ten_metres, bearing=32 * number % 6400)


DELAY_NS = round(1e9 * reply_delay(beam(0), 115200))


def errors(late_ms: np.ndarray, period: float = PERIOD) -> np.ndarray:
    """Return by how much [ms] the stamps miss the true transmissions."""
    true = START_NS + np.round(np.arange(len(late_ms)) * period).astype(np.int64)
    received = np.maximum.accumulate(true + DELAY_NS + np.round(late_ms * MS).astype(np.int64))
    clock = TransmitClock(115200)
    stamps = [clock.stamp(int(at), beam(i)) for i, at in enumerate(received)]
    assert (np.diff(stamps) > 0).all()
    return np.asarray((np.array(stamps) - true) / MS)


def test_a_quiet_line_has_less_than_five_milliseconds_of_jitter() -> None:
    late = np.abs(np.random.default_rng(1).normal(0.0, 1.0, 1000))
    assert np.abs(errors(late)).max() < 5.0
    assert errors(late)[50:].std() < 0.5


@pytest.mark.parametrize("share", [0.95, 1.05])
def test_a_head_faster_or_slower_than_modelled_is_followed(share: float) -> None:
    missed = errors(np.zeros(500), share * PERIOD)
    assert np.abs(missed[20:]).max() < 8.0
    assert missed[100:].std() < 2.0


def test_the_timer_of_a_usb_adapter_is_filtered_out() -> None:
    late = np.random.default_rng(2).uniform(0.0, 16.0, 1000)
    assert errors(late)[50:].std() < 0.5 * late.std()


def test_beams_of_one_piece_are_a_period_apart() -> None:
    clock = TransmitClock(115200)
    first = clock.stamp_all(START_NS, [beam(i) for i in range(4)])
    assert np.diff(first) == pytest.approx([PERIOD] * 3, abs=MS)
    assert first[-1] == START_NS - DELAY_NS
    second = clock.stamp_all(START_NS + round(3 * PERIOD), [beam(i) for i in range(4, 7)])
    assert np.diff([first[-1], *second]) == pytest.approx([PERIOD] * 3, abs=MS)


def test_a_lost_beam_takes_its_time() -> None:
    clock = TransmitClock(115200)
    for i in range(20):
        last = clock.stamp(START_NS + round(i * PERIOD), beam(i))
    later = clock.stamp(START_NS + round(22 * PERIOD), beam(22))
    assert later - last == pytest.approx(3 * PERIOD, abs=MS)
    assert clock.restarts == {"first_beam": 1}


@pytest.mark.parametrize(("jump_s", "reason"), [(1.0, "pause"), (-3600.0, "clock_set_back")])
def test_pauses_and_clocks_set_back_are_followed_at_once(jump_s: float, reason: str) -> None:
    clock = TransmitClock(115200)
    for i in range(20):
        clock.stamp(START_NS + round(i * PERIOD), beam(i))
    received = START_NS + round(20 * PERIOD + jump_s * 1e9)
    assert clock.stamp(received, beam(20)) == received - DELAY_NS
    assert clock.restarts[reason] == 1


def test_stamps_do_not_run_ahead_of_a_clock_that_stands_still() -> None:
    clock = TransmitClock(115200)
    stamps = [clock.stamp(START_NS, beam(i)) for i in range(2000)]
    assert max(stamps) <= START_NS + 1_100_000_000


def test_stamps_of_a_real_log_are_steadier_than_its_receipts() -> None:
    framer, clock, stamps, receipts = Framer(), TransmitClock(115200), [], []
    for line in needed(UDP_LOG).read_text(encoding="ascii").splitlines():
        time, _, port, content = line.split(";", 3)
        if port != "4002":
            continue
        hours, minutes, rest = time.split()[1].split(".", 2)
        seconds = 3600 * int(hours) + 60 * int(minutes) + float(rest)
        for frame in framer.feed(bytes.fromhex(content)):
            packet = decode_packet(frame)
            if isinstance(packet, HeadData):
                receipts.append(round(seconds * 1e9))
                stamps.append(clock.stamp(receipts[-1], packet))
    assert len(stamps) > 700
    assert np.diff(receipts).std() > 7 * MS
    assert np.diff(stamps).std() < 2 * MS
