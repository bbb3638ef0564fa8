# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""A driver at an emulated head, each a process, and what can be heard of them."""

import re
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from nodes.fed_nodes import DIAGNOSTICS, Fed
from nodes.processes import Domain, NodeProcess, TestNode, domain, wait_until

from msss_graphslam.core.types import Beam
from msss_graphslam.messages import decoding, topics
from msss_graphslam.ros.messages import make, message_class

__all__ = ["Driven", "driven", "emulated", "level_and_text"]

_MAIN = "import sys; from msss_graphslam.simulation.emulator.main import main; sys.exit(main())"


def emulated(own: Domain, *arguments: object) -> NodeProcess:
    """Return an emulator, to be used as a context manager."""
    return NodeProcess([sys.executable, "-c", _MAIN, *map(str, arguments)], own)


class Driven(Fed):
    """Hears a driver, asks it, and sets its parameters."""

    def __init__(self, own: Domain, test: TestNode, process: NodeProcess) -> None:
        super().__init__(test, "micron_driver")
        self.own, self.test, self.process = own, test, process
        for topic in (DIAGNOSTICS, topics.SONAR_PING):
            self.hear(topic)

    @property
    def beams(self) -> list[Beam]:
        return [decoding.beam(message) for message in self.heard(topics.SONAR_PING)]

    def await_beams(self, count: int) -> list[Beam]:
        """Return all beams so far, once there are so many."""
        wait_until(lambda: len(self.heard(topics.SONAR_PING)) >= count, f"{count} beams")
        return self.beams

    def await_more(self, count: int) -> list[Beam]:
        """Return the next beams from now on."""
        before = len(self.heard(topics.SONAR_PING))
        return self.await_beams(before + count)[before:]

    def await_text(self, pattern: str) -> int:
        """Wait until the diagnostics' message has the pattern; return the level."""
        found = wait_until(lambda: level_and_text(self, pattern), f"{pattern!r} in the message")
        return int(found[0])

    def await_row(self, key: str, value: str) -> None:
        wait_until(lambda: self.diagnostic(key) == value, f"{key} = {value}")

    def set(self, **values: Any) -> Any:
        """Set parameters as ``ros2 param set`` does; return the result of the last."""
        kind = message_class("rcl_interfaces/srv/SetParametersAtomically")
        parameters = [_parameter(name, value) for name, value in values.items()]
        service = "/micron_driver/set_parameters_atomically"
        return self.test.call(kind, service, parameters=parameters).result


@contextmanager
def driven(*arguments: str, own: Domain | None = None, **parameters: Any) -> Iterator[Driven]:
    """Start a driver in a domain of its own, or in this one; give what hears it."""
    if own is None:
        with domain() as found, driven(*arguments, own=found, **parameters) as driver:
            yield driver
        return
    start = own.start("micron_driver", *arguments, **parameters)
    with TestNode(own) as test, start as process:
        yield Driven(own, test, process)


def level_and_text(driver: Driven, pattern: str) -> tuple[int, str] | None:
    """Return level and message of the newest diagnostics, if the message has the pattern."""
    found = [m.status[0] for m in driver.heard(DIAGNOSTICS)]
    own = [status for status in found if status.name == "/micron_driver"]
    if not own or not re.search(pattern, own[-1].message):
        return None
    return own[-1].level[0], own[-1].message


def _parameter(name: str, value: Any) -> Any:
    kinds = {bool: (1, "bool_value"), int: (2, "integer_value"), float: (3, "double_value")}
    number, field = kinds.get(type(value), (4, "string_value"))
    held = make("rcl_interfaces/msg/ParameterValue", **{"type": number, field: value})
    return make("rcl_interfaces/msg/Parameter", name=name, value=held)


def port_at(folder: Path) -> Path:
    """Return where an emulator's pseudo-terminal is to be found."""
    return folder / "head"
