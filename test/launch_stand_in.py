# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""As much of ``launch`` and ``launch_ros`` as tells what a launch file would start.

Both exist only where ROS is installed. The classes take the arguments that the real ones take, and
no others; :func:`run` goes through a launch file as ``ros2 launch`` does, but starts nothing.
"""

import os
import runpy
import sys
from collections.abc import Callable, Iterable
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path
from types import ModuleType
from typing import Any
from unittest.mock import patch

import yaml

SHARE = Path(__file__).parents[1]
"""The repository is laid out as the package's share directory is."""


class ArgumentError(Exception):
    """What ``ros2 launch`` ends with: an argument is missing or not one of the choices."""


@dataclass
class LaunchDescription:
    entities: list[Any]


@dataclass
class DeclareLaunchArgument:
    name: str
    default_value: Any = field(default=None, kw_only=True)
    description: str | None = field(default=None, kw_only=True)
    choices: list[str] | None = field(default=None, kw_only=True)


@dataclass
class PythonLaunchDescriptionSource:
    path: Any


@dataclass
class IncludeLaunchDescription:
    source: PythonLaunchDescriptionSource
    launch_arguments: Iterable[tuple[str, Any]] = field(default=(), kw_only=True)


@dataclass(kw_only=True)
class Shutdown:
    reason: str


@dataclass
class LaunchConfiguration:
    name: str

    def perform(self, context: "Launched") -> str:
        return context.values[self.name]


@dataclass
class OpaqueFunction:
    function: Callable[["Launched"], Iterable[Any]] = field(kw_only=True)


@dataclass
class PathJoinSubstitution:
    parts: list[Any]


@dataclass
class EqualsSubstitution:
    left: Any
    right: Any


@dataclass
class NotEqualsSubstitution:
    left: Any
    right: Any


@dataclass
class FindPackageShare:
    package: str


@dataclass
class IfCondition:
    predicate: Any


@dataclass
class ParameterValue:
    value: Any
    value_type: type = field(kw_only=True)


@dataclass(kw_only=True)
class Node:
    package: str
    executable: str
    namespace: Any
    parameters: list[Any]
    output: str
    condition: IfCondition | None = None
    on_exit: Shutdown | None = None


@dataclass(frozen=True)
class Started:
    """A process that the launch file starts; later parameters have replaced earlier ones."""

    executable: str
    namespace: str
    parameters: dict[str, Any]
    files: list[Path]
    ends_all: bool


@dataclass
class Launched:
    arguments: list[DeclareLaunchArgument] = field(default_factory=list)
    nodes: list[Started] = field(default_factory=list)
    values: dict[str, str] = field(default_factory=dict)

    def visit(self, entity: Any) -> None:
        """Do what ``launch`` does at this entity."""
        steps: dict[type, Callable[[Any], None]] = {
            DeclareLaunchArgument: self._declare,
            IncludeLaunchDescription: self._include,
            OpaqueFunction: self._perform,
            Node: self._start,
        }
        steps[type(entity)](entity)

    def _declare(self, argument: DeclareLaunchArgument) -> None:
        self.arguments.append(argument)
        if argument.name not in self.values:
            if argument.default_value is None:
                raise ArgumentError(f"{argument.name} is missing")
            self.values[argument.name] = self.text(argument.default_value)
        if argument.choices and self.values[argument.name] not in argument.choices:
            raise ArgumentError(f"{argument.name} is none of {argument.choices}")

    def _perform(self, action: OpaqueFunction) -> None:
        for entity in action.function(self):
            self.visit(entity)

    def _include(self, include: IncludeLaunchDescription) -> None:
        for name, value in include.launch_arguments:
            self.values[name] = self.text(value)
        for entity in description(Path(self.text(include.source.path))).entities:
            self.visit(entity)

    def _start(self, node: Node) -> None:
        assert node.package == "msss_graphslam"
        if node.condition is not None and self.text(node.condition.predicate) != "true":
            return
        own = [entry for entry in node.parameters if isinstance(entry, dict)]
        files = [entry for entry in node.parameters if not isinstance(entry, dict)]
        self.nodes.append(
            Started(
                node.executable,
                self.text(node.namespace),
                {name: self._typed(value) for entry in own for name, value in entry.items()},
                [Path(self.text(entry)) for entry in files],
                node.on_exit is not None,
            )
        )

    def _typed(self, parameter: ParameterValue | str | list[str]) -> Any:
        if not isinstance(parameter, ParameterValue):
            return parameter
        text = self.text(parameter.value)
        if parameter.value_type is not bool:
            return parameter.value_type(text)
        value = yaml.safe_load(text)
        assert isinstance(value, bool)
        return value

    def text(self, value: Any) -> str:
        """Perform a substitution."""
        match value:
            case str():
                return value
            case LaunchConfiguration(name):
                return self.values[name]
            case PathJoinSubstitution(parts):
                return str(Path(*map(self.text, parts)))
            case EqualsSubstitution(left, right):
                return str(self.text(left) == self.text(right)).lower()
            case NotEqualsSubstitution(left, right):
                return str(self.text(left) != self.text(right)).lower()
            case FindPackageShare("msss_graphslam"):
                return str(SHARE)
        raise TypeError(f"not a substitution: {value!r}")


MODULES: dict[str, list[type]] = {
    "launch": [LaunchDescription],
    "launch.actions": [
        DeclareLaunchArgument,
        IncludeLaunchDescription,
        OpaqueFunction,
        Shutdown,
    ],
    "launch.conditions": [IfCondition],
    "launch.launch_description_sources": [PythonLaunchDescriptionSource],
    "launch.substitutions": [
        EqualsSubstitution,
        LaunchConfiguration,
        NotEqualsSubstitution,
        PathJoinSubstitution,
    ],
    "launch_ros": [],
    "launch_ros.actions": [Node],
    "launch_ros.parameter_descriptions": [ParameterValue],
    "launch_ros.substitutions": [FindPackageShare],
}


def description(path: Path) -> LaunchDescription:
    """Return what a launch file describes."""
    modules = {}
    for name, classes in MODULES.items():
        modules[name] = ModuleType(name)
        vars(modules[name]).update({kind.__name__: kind for kind in classes})
    modules["launch"].LaunchContext = Launched  # type: ignore[attr-defined]
    with ExitStack() as stack:
        stack.enter_context(patch.dict("sys.modules", modules))
        found = runpy.run_path(str(path))["generate_launch_description"]()
    assert isinstance(found, LaunchDescription)
    return found


def run(name: str, **given: str) -> Launched:
    """Return what ``ros2 launch msss_graphslam NAME given...`` would start."""
    launched = Launched(values=dict(given))
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
    with patch.dict("os.environ", PATH=path):
        for entity in description(SHARE / "launch" / name).entities:
            launched.visit(entity)
    return launched
