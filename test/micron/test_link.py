# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""A line that comes and goes."""

from head_port import HeadPort
from micron.scripted_head import SECOND, START_NS, ScriptedHead

from msss_graphslam.config.groups import Micron
from msss_graphslam.micron.head_driver import HeadDriver
from msss_graphslam.micron.settings import HeadSettings
from msss_graphslam.micron.transports.link import Link
from msss_graphslam.micron.transports.transport import TransportEndedError, TransportError


class Clock:
    def __init__(self) -> None:
        self.now_ns = START_NS

    def seconds(self) -> float:
        return (self.now_ns - START_NS) * 1e-9

    def sleep(self, seconds: float) -> None:
        self.now_ns += max(round(seconds * SECOND), 1000)


class Cable:
    """A line to a scripted head that can be pulled out."""

    def __init__(self, clock: Clock, head: ScriptedHead) -> None:
        self.clock, self.head = clock, head
        self.plugged, self.error = True, TransportError("unplugged")
        self.attempts: list[float] = []

    def open(self) -> None:
        self.attempts.append(self.clock.seconds())
        self.check()

    def read(self, timeout: float) -> bytes:
        self.check()
        wait = min(timeout, max(self.head.next_ns - self.clock.now_ns, 0) * 1e-9)
        self.clock.sleep(wait)
        return b"".join(self.head.due(self.clock.now_ns))

    def write(self, data: bytes) -> None:
        self.check()
        self.head.receive(data, self.clock.now_ns)

    def close(self) -> None:
        pass

    def check(self) -> None:
        if not self.plugged:
            raise self.error


def plugged() -> tuple[Clock, Cable, HeadPort]:
    clock = Clock()
    cable = Cable(clock, ScriptedHead())
    link = Link(cable, clock.seconds, clock.sleep)
    driver = HeadDriver(HeadSettings(Micron()))
    return clock, cable, HeadPort(link, driver, lambda: clock.now_ns)


def run(port: HeadPort, clock: Clock, seconds: float) -> list[int]:
    """Return when beams came."""
    end_ns, beams = clock.now_ns + round(seconds * SECOND), []
    while clock.now_ns < end_ns:
        received = port.step(0.1)
        beams += [received.received_ns for _ in received.beams]
    return beams


def test_f7_unplugged_for_20_s() -> None:
    for pulled in (20.0, 18.0, 15.1):
        clock, cable, port = plugged()
        assert run(port, clock, 8.0)
        cable.plugged = False
        assert run(port, clock, pulled) == []
        assert port.link.error == "unplugged"
        cable.plugged, back_ns = True, clock.now_ns
        assert run(port, clock, 6.5)[0] - back_ns < 6 * SECOND
        assert port.link.openings == 2
        assert port.driver.status.counts["partial_turns"] == 1


def test_the_pauses_grow_from_half_a_second_to_five() -> None:
    clock, cable, port = plugged()
    cable.plugged = False
    run(port, clock, 25.0)
    pauses = [b - a for a, b in zip(cable.attempts, cable.attempts[1:], strict=False)]
    assert [round(pause, 1) for pause in pauses[:6]] == [0.5, 1.0, 2.0, 4.0, 5.0, 5.0]


def test_another_error_is_news_and_tried_again_soon() -> None:
    clock, cable, port = plugged()
    cable.plugged = False
    run(port, clock, 25.0)
    cable.error = TransportError("not permitted yet")
    run(port, clock, 5.5)
    assert len(cable.attempts) > 8


def test_a_source_at_its_end_is_not_begun_again() -> None:
    clock, cable, port = plugged()
    run(port, clock, 1.0)
    cable.plugged, cable.error = False, TransportEndedError("at its end")
    run(port, clock, 30.0)
    assert port.link.ended
    assert len(cable.attempts) == 1


def test_a_closed_port_is_closed() -> None:
    clock, _, port = plugged()
    run(port, clock, 1.0)
    port.close()
    assert not port.link.is_open
    assert port.driver.next_ns is None
