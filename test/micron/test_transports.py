# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Real pseudo-terminals, sockets and files as lines to a head."""

import os
import socket
from pathlib import Path

import pytest

from benchmarks.micron_stream import head_data
from msss_graphslam.micron.transports.file import RecordedFile
from msss_graphslam.micron.transports.serial_port import SerialPort
from msss_graphslam.micron.transports.tcp import TcpLine
from msss_graphslam.micron.transports.transport import TransportEndedError, TransportError


def test_a_serial_port_carries_any_bytes_both_ways() -> None:
    head, driver = os.openpty()
    line = SerialPort(os.ttyname(driver), 115200)
    line.open()
    every = bytes(range(256))
    os.write(head, every)
    assert line.read(2.0) == every
    line.write(every)
    assert os.read(head, 4096) == every
    assert line.read(0.0) == b""
    with pytest.raises(TransportError, match="another program"):
        SerialPort(os.ttyname(driver), 115200).open()
    os.close(driver)
    os.close(head)
    with pytest.raises(TransportError):
        line.read(2.0)
    line.close()
    line.close()


def test_a_port_that_is_missing_or_none_says_so(tmp_path: Path) -> None:
    with pytest.raises(TransportError, match="not there"):
        SerialPort(str(tmp_path / "none"), 115200).open()
    (tmp_path / "file").write_bytes(b"")
    with pytest.raises(TransportError, match="file"):
        SerialPort(str(tmp_path / "file"), 115200).open()
    with pytest.raises(TransportError, match="not open"):
        SerialPort("none", 115200).read(0.0)


def test_a_serial_server_carries_any_bytes_and_its_end_is_noticed() -> None:
    with socket.create_server(("127.0.0.1", 0)) as server:
        line = TcpLine(*server.getsockname())
        line.open()
        head, _ = server.accept()
        head.sendall(b"@\n\x00\xff")
        assert line.read(2.0) == b"@\n\x00\xff"
        line.write(b"\n@")
        assert head.recv(10) == b"\n@"
        assert line.read(0.0) == b""
        head.close()
        with pytest.raises(TransportError, match="ended"):
            line.read(2.0)
        line.close()
        address = server.getsockname()
    with pytest.raises(TransportError, match="serial server"):
        TcpLine(*address).open()


def test_a_file_gives_all_its_bytes_and_then_ends(tmp_path: Path) -> None:
    beam = head_data(bytes(200)).frame().encode()
    content = b"noise" + 3 * beam + b"@"
    (tmp_path / "raw").write_bytes(content)
    line = RecordedFile(tmp_path / "raw", 115200)
    line.open()
    data = b""
    with pytest.raises(TransportEndedError):
        while True:
            data += line.read(0.01)
    assert data == content
    with pytest.raises(TransportError, match="not there"):
        RecordedFile(tmp_path, 115200).open()
