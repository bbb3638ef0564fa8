# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The nodes of one vehicle as processes, and the replay that feeds them."""

import sys
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from nodes.processes import Domain, NodeProcess, as_yaml

from msss_graphslam.nodes.names import SLAM_NODES

__all__ = ["Fleet", "Surroundings"]

_REPLAY_LIMIT = 300.0


class Surroundings(Domain):
    """A domain whose processes have further variables, and a command before their own."""

    def __init__(
        self,
        number: int,
        variables: Mapping[str, str] | None = None,
        prefix: Mapping[str, Sequence[str]] | None = None,
    ) -> None:
        super().__init__(number)
        self._variables = dict(variables or {})
        self._prefix = dict(prefix or {})

    @property
    def environment(self) -> dict[str, str]:
        return {**super().environment, **self._variables}

    def prefix(self, name: str) -> list[str]:
        """The command that starts the process of that name in its place."""
        return list(self._prefix.get(name, self._prefix.get("", ())))


class Fleet:
    """The nodes of a vehicle; a context manager that ends what still runs.

    Parameters
    ----------
    domain
        Where they are.
    output
        The directory in which the back end leaves its files.
    namespace
        The vehicle's.
    """

    def __init__(self, domain: Domain, output: Path, namespace: str = "") -> None:
        self.output = output
        self.namespace = namespace
        self.nodes: dict[str, NodeProcess] = {}
        self._domain = domain
        self._stack = ExitStack()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._stack.__exit__(kind, error, trace)

    def full_name(self, node: str) -> str:
        """The node's name with its namespace."""
        return f"{self.namespace}/{node}"

    def start(self, *names: str, arguments: Sequence[str] = (), **parameters: Any) -> None:
        """Start the named nodes, or all; ``arguments`` are further ones for ROS."""
        for name in names or SLAM_NODES:
            given = dict(parameters)
            if name == "back_end":
                given["output"] = self.output
            self.nodes[name] = self._process(name, given, arguments)

    def kill(self, name: str) -> None:
        """Kill a node as kill -9 does; start it again by :meth:`start`."""
        self.nodes[name].kill()

    def replay(self, bag: Path, rate: float, **parameters: Any) -> NodeProcess:
        """Begin the replay of a bag, which ends by having all nodes save."""
        given = {"bag": bag, "rate": float(rate), **parameters}
        return self._process("bag_replay", given)

    def run(self, bag: Path, rate: float, **parameters: Any) -> None:
        """Replay a bag to its end, and see that no node ended with it."""
        self.finish(self.replay(bag, rate, **parameters))

    def finish(self, replay: NodeProcess) -> None:
        """Wait for the replay's end, and see that no node ended with it."""
        code = replay.wait(_REPLAY_LIMIT)
        assert code == 0, replay.output
        for name, node in self.nodes.items():
            assert node.is_running, f"{name} ended:\n{node.output}"
            assert "Traceback" not in node.output, f"{name}:\n{node.output}"

    def _process(
        self, name: str, parameters: Mapping[str, Any], arguments: Sequence[str] = ()
    ) -> NodeProcess:
        module = f"msss_graphslam.nodes.{name}"
        command = [*self._prefix(name), sys.executable, "-m", module, "--ros-args", *arguments]
        for key, value in parameters.items():
            command += ["-p", f"{key}:={as_yaml(value)}"]
        if self.namespace:
            command += ["-r", f"__ns:={self.namespace}"]
        return self._stack.enter_context(NodeProcess(command, self._domain))

    def _prefix(self, name: str) -> list[str]:
        return self._domain.prefix(name) if isinstance(self._domain, Surroundings) else []
