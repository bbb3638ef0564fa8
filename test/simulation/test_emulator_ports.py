# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The emulated head at real ports."""

import os
import select
import socket
import stat
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from threading import Event, Thread

import pytest
from emulated_head import Pattern
from emulated_lines import driven, read

from msss_graphslam.errors import UserError
from msss_graphslam.micron.transports.serial_port import SerialPort
from msss_graphslam.micron.transports.tcp import TcpLine
from msss_graphslam.micron.transports.transport import Transport
from msss_graphslam.simulation.emulator.emulator import Emulator
from msss_graphslam.simulation.emulator.faults import Faults, Span
from msss_graphslam.simulation.emulator.head import Head
from msss_graphslam.simulation.emulator.ports import Port, PseudoTerminal, TcpPort
from msss_graphslam.simulation.emulator.scanner import Nature
from msss_graphslam.simulation.emulator.serving import serve

Serve = Callable[[Port, Faults], None]


@pytest.fixture
def serving() -> Iterator[Serve]:
    """Serves an emulated head at a port, until the test ends."""
    stop = Event()
    threads: list[Thread] = []

    def start(port: Port, faults: Faults) -> None:
        now = time.time_ns()
        emulator = Emulator(Head(Pattern(), Nature(), now), faults, 1, now)
        port.plug()
        threads.append(Thread(target=serve, args=(emulator, port, stop.is_set)))
        threads[-1].start()

    yield start
    stop.set()
    for thread in threads:
        thread.join(10.0)
        assert not thread.is_alive()


def transport_to(port: Port) -> Transport:
    if isinstance(port, PseudoTerminal):
        return SerialPort(port.name, 115200)
    host, number = port.name.split(":")
    return TcpLine(host, int(number))


@pytest.mark.parametrize("kind", ["pty", "tcp"])
def test_a_driver_finds_it_loses_it_and_finds_it_again(
    kind: str, serving: Serve, tmp_path: Path
) -> None:
    link = tmp_path / "head"
    port = PseudoTerminal(link) if kind == "pty" else TcpPort(0)
    serving(port, Faults(unplugged=(Span(6.0, 1.0),)))
    driver = driven(transport_to(port))
    try:
        beams = read(driver, 20)
        assert len({beam.bearing for beam in beams}) == 20
        while driver.link.failures == 0:
            driver.step(0.1)
        assert read(driver, 20)[0].stamp_ns > beams[-1].stamp_ns
        assert driver.link.openings >= 2
    finally:
        driver.close()


def test_the_link_leads_to_a_terminal_and_goes_with_it(tmp_path: Path) -> None:
    link = tmp_path / "head"
    link.symlink_to(tmp_path / "of_an_earlier_run")
    port = PseudoTerminal(link)
    assert not port.plugged
    port.plug()
    assert port.plugged
    assert stat.S_ISCHR(link.stat().st_mode)
    port.unplug()
    port.unplug()
    assert not port.plugged
    assert not link.is_symlink()


def test_a_terminal_passes_all_bytes_as_they_are(tmp_path: Path) -> None:
    port = PseudoTerminal(tmp_path / "head")
    port.plug()
    driver = os.open(port.name, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
    every_byte = bytes(range(256))
    port.write(every_byte)
    assert select.select([driver], [], [], 5.0)[0]
    assert os.read(driver, 1000) == every_byte
    os.write(driver, every_byte)
    assert port.read(1.0) == every_byte
    os.close(driver)
    port.unplug()


def test_a_link_that_another_has_taken_stays(tmp_path: Path) -> None:
    link = tmp_path / "head"
    first, second = PseudoTerminal(link), PseudoTerminal(link)
    first.plug()
    second.plug()
    first.unplug()
    assert link.is_symlink()
    second.unplug()
    assert not link.is_symlink()


def test_a_file_is_not_replaced(tmp_path: Path) -> None:
    file = tmp_path / "thesis.tex"
    file.write_text("years of work")
    with pytest.raises(UserError, match="is there already"):
        PseudoTerminal(file).plug()
    assert file.read_text() == "years of work"


def test_a_link_that_cannot_be_made_is_said(tmp_path: Path) -> None:
    port = PseudoTerminal(tmp_path / "missing" / "head")
    with pytest.raises(UserError, match="cannot be made"):
        port.plug()
    assert not port.plugged


def test_a_driver_that_does_not_read_stops_nothing(tmp_path: Path) -> None:
    for port in (PseudoTerminal(tmp_path / "head"), TcpPort(0)):
        port.plug()
        transport = transport_to(port)
        transport.open()
        for _ in range(2000):
            port.read(0.0)
            port.write(bytes(10_000))
        transport.close()
        port.unplug()


def test_without_a_port_nothing_is_read_or_written(tmp_path: Path) -> None:
    for port in (PseudoTerminal(tmp_path / "head"), TcpPort(0)):
        port.write(b"lost")
        assert port.read(0.0) == b""
        port.unplug()


def test_a_tcp_port_serves_one_driver_after_the_other() -> None:
    port = TcpPort(0)
    port.plug()
    address = port.name.split(":")[0], int(port.name.split(":")[1])
    for word in (b"first", b"second"):
        with socket.create_connection(address, timeout=5.0) as driver:
            port.read(1.0)
            driver.sendall(word)
            assert port.read(1.0) == word
            port.write(b"answer")
            assert driver.recv(100) == b"answer"
        assert port.read(1.0) == b""
        port.write(b"to nobody")
    port.unplug()
    with pytest.raises(ConnectionRefusedError):
        socket.create_connection(address, timeout=1.0)


def test_a_port_in_use_is_said() -> None:
    first = TcpPort(0)
    first.plug()
    with pytest.raises(UserError, match="cannot listen there"):
        TcpPort(int(first.name.split(":")[1])).plug()
    first.unplug()
