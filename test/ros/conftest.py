# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Real rclpy over real DDS, a domain of its own for each test process."""

import os
import time
from collections.abc import Callable, Iterator
from typing import Any

import pytest

# Above 101 the ports meet those that Linux hands out; up to 60 they are those of the node tests.
os.environ["ROS_DOMAIN_ID"] = str(61 + os.getpid() % 41)
os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
os.environ["ROS_PYTHON_CHECK_FIELDS"] = "1"

_PATIENCE = 20.0


class Graph:
    """The nodes of a test and the executor that spins them."""

    def __init__(self, context: Any) -> None:
        from rclpy.executors import SingleThreadedExecutor

        self.context = context
        self._executor = SingleThreadedExecutor(context=context)
        self._nodes: list[Any] = []

    def add(self, node: Any) -> Any:
        self._nodes.append(node)
        self._executor.add_node(node)
        return node

    def until(self, condition: Callable[[], Any]) -> Any:
        """Spin until the condition holds; fail if it never does."""
        end = time.monotonic() + _PATIENCE
        while not (found := condition()):
            assert time.monotonic() < end, "never happened"
            self._executor.spin_once(timeout_sec=0.05)
        return found

    def answer(self, client: Any, request: Any) -> Any:
        """Call a service and return its answer."""
        self.until(client.service_is_ready)
        future = client.call_async(request)
        self.until(future.done)
        return future.result()

    def close(self) -> None:
        self._executor.shutdown()
        for node in self._nodes:
            node.destroy_node()


@pytest.fixture
def started() -> Iterator[Callable[..., Graph]]:
    """Return what starts ROS with arguments, as on a node's command line."""
    import rclpy

    graphs: list[Graph] = []

    def start(*arguments: str) -> Graph:
        rclpy.init(args=["--ros-args", *arguments] if arguments else [])
        graphs.append(Graph(rclpy.get_default_context()))
        return graphs[-1]

    yield start
    for graph in graphs:
        graph.close()
    rclpy.try_shutdown()


@pytest.fixture
def graph(started: Callable[..., Graph]) -> Graph:
    return started()


@pytest.fixture
def bench(graph: Graph) -> Any:
    """Return a ``listening_node.Bench``."""
    from listening_node import Bench

    return Bench(graph)
