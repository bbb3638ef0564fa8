# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The parameters of a replay."""

from collections.abc import Collection
from dataclasses import dataclass, fields
from typing import Any

from rclpy.node import Node

from msss_graphslam.errors import UserError
from msss_graphslam.messages import topics
from msss_graphslam.nodes.names import DRIVER, FED
from msss_graphslam.ros.messages import make

__all__ = ["ReplaySettings"]

_DESCRIBED: dict[str, tuple[Any, str]] = {
    "bag": ("", "an mcap file or a rosbag2 folder"),
    "rate": (1.0, "mission seconds a second; 0: as fast as it goes"),
    "start_offset": (0.0, "what is left out at the beginning [s]"),
    "loop": (False, "begin anew at the end, the nodes reset before each lap"),
    "topics": ([""], "topics to replay; none: the inputs of the package that the bag has"),
    "wait_for": (
        list(FED),
        "nodes in the own namespace that must listen before anything is sent; [''] for none;"
        " with these two also micron_driver where sonar/raw is replayed",
    ),
    "clock": (True, "publish /clock"),
    "conclude": (True, "at the end have every node work off what it holds, and save"),
    "patience": (60.0, "how long to wait for a node that stops listening in mid-replay [s]"),
}


@dataclass(frozen=True, slots=True)
class ReplaySettings:
    """What a replay was asked for; meanings stand in the parameters' descriptions."""

    bag: str
    rate: float
    start_offset: float
    loop: bool
    topics: list[str]
    wait_for: list[str]
    clock: bool
    conclude: bool
    patience: float

    @classmethod
    def of(cls, node: Node) -> "ReplaySettings":
        """Declare the parameters and read them; raises UserError where one makes no sense."""
        values = {field.name: _declare(node, field.name) for field in fields(cls)}
        for name in ("rate", "start_offset", "patience"):
            values[name] = _number(name, values[name])
        for name in ("topics", "wait_for"):
            values[name] = [text for text in values[name] if text]
        if not values["bag"]:
            raise UserError("parameter bag is missing: give an mcap file or a rosbag2 folder")
        return cls(**values)

    def awaited(self, replayed: Collection[str]) -> list[str]:
        """Return the nodes to wait for, given the names of the topics that are replayed."""
        if set(FED) <= set(self.wait_for) and topics.SONAR_RAW.name in replayed:
            return list(dict.fromkeys([DRIVER, *self.wait_for]))
        return self.wait_for


def _declare(node: Node, name: str) -> Any:
    default, description = _DESCRIBED[name]
    # Whole numbers are welcome where rclpy would insist on 20.0.
    descriptor = make(
        "rcl_interfaces/msg/ParameterDescriptor",
        description=description,
        read_only=True,
        dynamic_typing=isinstance(default, float),
    )
    return node.declare_parameter(name, default, descriptor).value


def _number(name: str, value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not 0.0 <= value < 1e9:
        raise UserError(f"parameter {name} is {value!r}, must be a number of at least 0")
    return float(value)
