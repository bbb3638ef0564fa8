# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The driver at a real port, in real time."""

import time

from head_port import HeadPort

from msss_graphslam.config.groups.micron import Micron
from msss_graphslam.core.types import Beam
from msss_graphslam.micron.head_driver import HeadDriver
from msss_graphslam.micron.settings import HeadSettings
from msss_graphslam.micron.transports.link import Link
from msss_graphslam.micron.transports.transport import Transport

__all__ = ["driven", "read"]

PATIENCE = 60.0


def driven(transport: Transport) -> HeadPort:
    """Return a driver at the end of a line."""
    return HeadPort(Link(transport), HeadDriver(HeadSettings(Micron(range_m=10.0, bins=200))))


def read(port: HeadPort, count: int) -> list[Beam]:
    """Return the next beams, that many."""
    beams: list[Beam] = []
    give_up = time.monotonic() + PATIENCE
    while len(beams) < count:
        assert time.monotonic() < give_up, port.link.error or port.driver.status
        beams += port.step(0.1).beams
    return beams
