# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What a node says of itself on /diagnostics, once a second."""

from collections import Counter, deque
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from enum import IntEnum
from math import isfinite
from time import monotonic
from typing import Any

from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.node import Node

from msss_graphslam.ros.input_watch import InputWatch
from msss_graphslam.ros.messages import make, message_class

__all__ = ["HARDWARE_ID", "TOPIC", "Diagnostics", "Finding", "Level"]

TOPIC = "/diagnostics"
HARDWARE_ID = "msss_graphslam"

_ARRAY = "diagnostic_msgs/msg/DiagnosticArray"
_STATUS = "diagnostic_msgs/msg/DiagnosticStatus"
_KEY_VALUE = "diagnostic_msgs/msg/KeyValue"
_DEPTH = 100
_PERIOD = 1.0
# For so long a refusal shows as a warning [s].
_RECENT = 10.0

Value = str | int | float


class Level(IntEnum):
    """How it stands, as in diagnostic_msgs/DiagnosticStatus."""

    OK = 0
    WARN = 1
    ERROR = 2


@dataclass(frozen=True, slots=True)
class Finding:
    """Something that a person has to know."""

    level: Level
    text: str


class Diagnostics:
    """The diagnostics of a node: inputs, refusals, values, findings.

    ``refused`` counts what was dropped by reason. ``values`` are further rows, asked for at each
    publication; so are ``checks``, which return what they find wrong.
    """

    def __init__(self, node: Node) -> None:
        self.refused: Counter[str] = Counter()
        self.values: dict[str, Callable[[], Value]] = {}
        self.checks: list[Callable[[], Finding | None]] = []
        self._node = node
        self._inputs: dict[str, InputWatch] = {}
        self._findings: dict[Level, str] = {}
        self._history: deque[tuple[float, int]] = deque([(monotonic(), 0)])
        self._publisher = node.create_publisher(message_class(_ARRAY), TOPIC, _DEPTH)
        self._timer = node.create_timer(
            _PERIOD, self.publish, clock=Clock(clock_type=ClockType.STEADY_TIME)
        )

    def input(self, topic_name: str) -> InputWatch:
        """Return the watch of an input, the same for the same name."""
        if topic_name not in self._inputs:
            self._inputs[topic_name] = InputWatch(topic_name, monotonic)
        return self._inputs[topic_name]

    def forget(self, topic_name: str) -> None:
        """Show the input no more."""
        self._inputs.pop(topic_name, None)

    def warn(self, text: str) -> None:
        """Show a warning until cleared."""
        self._findings[Level.WARN] = text

    def error(self, text: str) -> None:
        """Show an error until cleared."""
        self._findings[Level.ERROR] = text

    def clear(self) -> None:
        """Take back warning and error."""
        self._findings.clear()

    def findings(self) -> list[Finding]:
        """Return what is wrong now, the worst first."""
        found = [Finding(level, text) for level, text in self._findings.items()]
        found += filter(None, [self._asked(check) for check in self.checks])
        found += self._recent_refusals()
        return sorted(found, key=lambda finding: -finding.level)

    def rows(self) -> dict[str, str]:
        """Return every value by its key, all finite."""
        rows: dict[str, Value | None] = {}
        for watch in self._inputs.values():
            rows.update(watch.values)
        rows.update({f"refused/{reason}": count for reason, count in self.refused.items()})
        rows.update({key: self._asked(value) for key, value in self.values.items()})
        return {key: _text(value) for key, value in rows.items()}

    def publish(self) -> None:
        """Publish now."""
        rows = self.rows()
        found = self.findings()
        status = make(
            _STATUS,
            level=bytes([found[0].level if found else Level.OK]),
            name=self._node.get_fully_qualified_name(),
            message="; ".join(finding.text for finding in found) or "running",
            hardware_id=HARDWARE_ID,
            values=[make(_KEY_VALUE, key=key, value=text) for key, text in rows.items()],
        )
        message = make(_ARRAY, status=[status])
        message.header.stamp = self._node.get_clock().now().to_msg()
        self._publisher.publish(message)

    def _asked(self, question: Callable[[], Any]) -> Any:
        """Return the answer, None where there is none: diagnostics must not end a node."""
        try:
            return question()
        except Exception as error:
            if not self.refused["internal_error"]:
                self._node.get_logger().error(f"diagnostics: {error!r}")
            self.refused["internal_error"] += 1
            return None

    def _recent_refusals(self) -> Iterator[Finding]:
        now, total = monotonic(), self.refused.total()
        while len(self._history) > 1 and now - self._history[1][0] > _RECENT:
            self._history.popleft()
        recent = total - self._history[0][1]
        self._history.append((now, total))
        if recent > 0:
            yield Finding(Level.WARN, f"refused {recent} in the last {_RECENT:g} s")


def _text(value: Value | None) -> str:
    if isinstance(value, float):
        return f"{value:.9g}" if isfinite(value) else "none"
    return "none" if value is None else str(value)
