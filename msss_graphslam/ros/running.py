# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""A node as a process: started, spun, ended."""

import os
import signal
import sys
from collections.abc import Callable
from typing import Any, NoReturn

import rclpy
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.signals import SignalHandlerOptions
from rclpy.utilities import try_shutdown

from msss_graphslam.errors import UserError

__all__ = ["begin", "leave", "run"]

# How long a signal may wait for a quiet node [s].
_PULSE = 0.1


class _Stop:
    """Ends the loop between two callbacks at the first signal, the process at the second."""

    def __init__(self) -> None:
        self.asked = False
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, self._ask)

    def _ask(self, _number: int, _frame: object) -> None:
        self.asked = True
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, signal.SIG_DFL)


def run(node_class: Callable[[], Any]) -> int:
    """Run the node until SIGINT, SIGTERM or the context's shutdown; return the exit code."""
    stop = _Stop()
    try:
        rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
        node = node_class()
    except Exception as error:
        name = getattr(node_class, "__name__", "node")
        print(f"{name}: {' '.join(str(error).split())}", file=sys.stderr)
        try_shutdown()
        return 1
    try:
        _spin(node, stop)
        node.faults.guarded(node.on_shutdown, "shutdown")()
    finally:
        node.destroy_node()
        try_shutdown()
    return 0


def begin() -> None:
    """Begin with ROS for a node that handles signals itself; UserError for wrong arguments."""
    try:
        rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    except RuntimeError as error:
        raise UserError(" ".join(str(error).split())) from error


def leave(code: int) -> NoReturn:
    """End the process, whose node is destroyed and has told the others so.

    The middleware's libraries would take half a second more to tidy up what ends with the process.
    """
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(code)


def _spin(node: Any, stop: _Stop) -> None:
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    # A signal cannot wake the middleware's wait; a timer does.
    node.every(_PULSE, node.pulse)
    while not stop.asked:
        try:
            executor.spin_once()
        except ExternalShutdownException:
            return
        except Exception as error:
            node.faults.note(error, "callback")
