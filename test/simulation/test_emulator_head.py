# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The emulated head as its driver finds it: from power-up to beams."""

import numpy as np
import pytest
from emulated_head import Host, command

from msss_graphslam.micron.packets import (
    HeadData,
    Reboot,
    SendData,
    SendUserData,
    SendVersion,
    StopAlives,
    UserData,
    VersionData,
)
from msss_graphslam.micron.timing import beam_period, listening_time, reply_delay
from msss_graphslam.simulation.emulator.scanner import Nature

FULL, HALF = Nature(), Nature(full_duplex=False)


def test_a_head_starts_as_its_maker_says() -> None:
    host = Host()
    host.wait_until(4.6)
    assert [flags for _, flags in host.alives] == [0x5D, 0x4D, 0x4A, 0x4A, 0x4A]
    times = [at for at, _ in host.alives]
    np.testing.assert_allclose(times, [0.5, 1.5, 2.5, 3.5, 4.5], atol=0.003)
    host.send(command())
    host.wait(3.0)
    assert [flags for _, flags in host.alives[5:]] == [0xCA, 0x8A, 0x8A]
    notices = [heard.packet.notice for heard in host.heard]  # type: ignore[union-attr]
    assert notices == [0x80] * 6 + [0, 0]


@pytest.mark.parametrize(("at", "reason"), [(0.4, ""), (0.6, "not centred"), (1.9, "not centred")])
def test_a_head_that_comes_to_itself_takes_no_parameters(at: float, reason: str) -> None:
    host = Host()
    host.send(command(), after=at)
    host.wait_until(6.0)
    assert {flags for _, flags in host.alives} == {0x5D, 0x4D, 0x4A}
    assert dict(host.head.ignored) == ({reason: 1} if reason else {})


@pytest.mark.parametrize("nature", [FULL, HALF])
def test_it_says_its_version_and_the_kind_of_its_line(nature: Nature) -> None:
    host = Host(nature)
    host.wait_until(3.0)
    host.send(SendVersion(), SendUserData())
    host.wait(0.1)
    (version,), (user,) = host.of(VersionData), host.of(UserData)
    assert version.packet.frame().payload.hex() == "3111000012b00000eb2a02"
    assert user.packet.frame().size == 264
    assert user.packet.full_duplex is nature.full_duplex  # type: ignore[union-attr]
    assert 3.0 < version.at < user.at < 3.05


@pytest.mark.parametrize(("nature", "beams"), [(FULL, 2), (HALF, 1)])
def test_a_request_brings_two_beams_in_full_duplex_and_one_in_half(
    nature: Nature, beams: int
) -> None:
    host = Host(nature).set_up()
    host.send(SendData())
    host.wait(0.9)
    assert len(host.of(HeadData)) == beams
    host.send(*[SendData()] * 50)
    host.wait(0.9)
    assert len(host.of(HeadData)) == 3 * beams


@pytest.mark.parametrize("nature", [FULL, HALF])
@pytest.mark.parametrize(
    ("bins", "ad_interval", "step"),
    [(200, 104, 32), (200, 208, 64), (396, 53, 32), (794, 133, 32), (800, 26, 4)],
)
def test_it_keeps_the_pace_of_real_heads(
    nature: Nature, bins: int, ad_interval: int, step: int
) -> None:
    host = Host(nature).set_up(bins=bins, ad_interval=ad_interval, step=step)
    requests = 0
    while len(host.of(HeadData)) < 40:
        if requests * nature.replies <= len(host.of(HeadData)):
            host.send(SendData())
            requests += 1
        host.wait(0.001)
    period = beam_period(
        listening_time(ad_interval, bins), step * 2 * np.pi / 6400, bins, nature.baudrate
    )
    pings = np.array([time for _, time in host.look.pings])
    late = 2.0 if nature is FULL else 5.0
    assert np.diff(pings)[4:].mean() == pytest.approx(period, abs=late * 1e-3)
    assert np.diff(pings).min() >= period - 1e-6
    delays = [heard.at - ping for heard, ping in zip(host.of(HeadData), pings, strict=False)]
    expected = reply_delay(host.of(HeadData)[0].packet, nature.baudrate)  # type: ignore[arg-type]
    assert min(delays) >= expected - 1e-6
    assert np.median(delays) <= expected + late * 1e-3


def test_an_echo_does_not_grow_old_before_it_is_sent() -> None:
    host = Host(HALF).set_up()
    host.scan(3)
    host.wait(10.0)
    asked = host.time
    host.send(SendData())
    host.wait(0.5)
    assert host.look.pings[-1][1] == pytest.approx(asked, abs=1e-6)
    assert len(host.look.pings) == len(host.of(HeadData))


def test_alives_pause_while_it_scans() -> None:
    host = Host().set_up()
    said = len(host.alives)
    host.scan(100)
    assert len(host.alives) == said
    host.wait(5.0)
    assert [flags for _, flags in host.alives[said:]] == [0x8A] * (len(host.alives) - said)
    assert len(host.alives) - said in (3, 4)


def test_alives_stop_on_demand_until_the_next_start() -> None:
    host = Host()
    host.wait_until(3.0)
    host.send(StopAlives())
    said = len(host.alives)
    host.send(command(), SendData(), after=1.0)
    host.wait(5.0)
    assert len(host.alives) == said
    assert len(host.of(HeadData)) == 2
    host.send(Reboot())
    host.wait(2.0)
    assert [flags for _, flags in host.alives[said:]] == [0x5D, 0x4D]


def test_a_rebooted_head_has_forgotten_its_parameters() -> None:
    host = Host().set_up()
    host.scan(3)
    already = len(host.of(HeadData))
    host.send(SendData(), Reboot())
    host.wait(3.0)
    host.send(SendData())
    host.wait(2.0)
    assert len(host.of(HeadData)) == already
    assert host.alives[-1][1] == 0x4A
    assert host.head.ignored == {"no parameters": 1}
    assert host.set_up().scan(1)[0].bearing == 3200
