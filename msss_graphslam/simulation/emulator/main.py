# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The entry point of ``micron_emulator``."""

import signal
import sys
import time
from argparse import Namespace
from collections.abc import Sequence
from threading import Event

from msss_graphslam.errors import UserError
from msss_graphslam.simulation.emulator.emulator import Emulator
from msss_graphslam.simulation.emulator.head import Head
from msss_graphslam.simulation.emulator.options import faults_of, nature_of, parser, port_of
from msss_graphslam.simulation.emulator.serving import serve
from msss_graphslam.simulation.emulator.view import View
from msss_graphslam.simulation.worlds import world_named

__all__ = ["main"]


def main(arguments: Sequence[str] | None = None) -> int:
    """Emulate a head until SIGINT or SIGTERM; return the exit code.

    The first line on standard output names the port, once a driver may open it.
    """
    parsed = parser().parse_args(arguments)
    stop = Event()
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: stop.set())
    try:
        _emulate(parsed, stop)
    except UserError as error:
        print(f"micron_emulator: {error}", file=sys.stderr)
        return 1
    return 0


def _emulate(arguments: Namespace, stop: Event) -> None:
    faults, port = faults_of(arguments), port_of(arguments)
    view = View(world_named(arguments.world), arguments.seed, arguments.echo)
    port.plug()
    print(f"micron_emulator: a head in the {arguments.world} at {port.name}", flush=True)
    started_ns = time.time_ns()
    head = Head(view, nature_of(arguments), started_ns)
    serve(Emulator(head, faults, arguments.seed, started_ns), port, stop.is_set)
