# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The emulated head at a real port, in real time."""

import time
from collections.abc import Callable

from msss_graphslam.simulation.emulator.emulator import Emulator
from msss_graphslam.simulation.emulator.ports import Port

__all__ = ["serve"]

_LONGEST_WAIT = 0.1


def serve(
    emulator: Emulator,
    port: Port,
    stopped: Callable[[], bool],
    clock: Callable[[], int] = time.time_ns,
) -> None:
    """Answer at the ``port`` until ``stopped``; ``clock`` gives the emulator's time [ns].

    The port is there at first if it is not plugged yet, and gone at the end.
    """
    try:
        while not stopped():
            _step(emulator, port, clock)
    finally:
        port.unplug()


def _step(emulator: Emulator, port: Port, clock: Callable[[], int]) -> None:
    """Do what is due, then wait for the driver or for what comes next."""
    now_ns = clock()
    plugged = emulator.plugged(now_ns)
    if plugged != port.plugged:
        (port.plug if plugged else port.unplug)()
    for piece in emulator.due(now_ns):
        port.write(piece)
    wait = (emulator.next_ns - clock()) * 1e-9
    received = port.read(min(max(wait, 0.0), _LONGEST_WAIT))
    if received:
        emulator.receive(received, clock())
