# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The nodes take what the launch files give them, as launch writes it on their command lines."""

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

import pytest
import yaml
from launch_stand_in import Launched, Started, run
from nodes.processes import Domain, NodeProcess, TestNode, domain
from rcl_interfaces.srv import GetParameters
from rclpy.parameter import parameter_value_to_python
from sample_bags import write_bag

pytestmark = pytest.mark.slow


@pytest.fixture
def at() -> Iterator[Domain]:
    with domain() as found:
        yield found


def arguments(node: Started, folder: Path) -> list[str]:
    """Return the node's arguments: a namespace always, each dictionary in a file of its own."""
    own = folder / f"{node.executable}.yaml"
    parameters = {"/**": {"ros__parameters": node.parameters}}
    own.write_text(yaml.dump(parameters, default_flow_style=False), encoding="utf-8")
    files = [part for path in (*node.files, own) for part in ("--params-file", str(path))]
    return ["-r", f"__ns:=/{node.namespace}", *files]


@contextmanager
def started(launched: Launched, at: Domain, folder: Path) -> Iterator[dict[str, NodeProcess]]:
    """Start every node of a launch file in the domain."""
    with ExitStack() as stack:
        yield {
            node.executable: stack.enter_context(
                at.start(node.executable, *arguments(node, folder))
            )
            for node in launched.nodes
        }


def values(source: TestNode, node: str, names: list[str]) -> dict[str, Any]:
    """Return parameters of a node, as ``ros2 param get`` tells them."""
    answer = source.call(GetParameters, f"{node}/get_parameters", names=names)
    return dict(zip(names, map(parameter_value_to_python, answer.values), strict=True))


@pytest.mark.parametrize("namespace", ["", "auv"])
def test_live_nodes_have_what_was_asked_for(at: Domain, tmp_path: Path, namespace: str) -> None:
    asked = {"namespace": namespace, "output": "123", "record": str(tmp_path / "dive.mcap")}
    launched = run("slam.launch.py", **asked, sonar="raw", estimator="uspic")
    with started(launched, at, tmp_path) as processes, TestNode(at) as source:
        for node in launched.nodes:
            name = f"{namespace and '/'}{namespace}/{node.executable}"
            assert values(source, name, [*node.parameters]) == node.parameters
        assert [process.interrupt() for process in processes.values()] == [0] * len(processes)
        assert "parameter" not in "".join(process.output for process in processes.values())


def test_a_replay_reaches_the_nodes_in_a_namespace(at: Domain, tmp_path: Path) -> None:
    launched = run("replay.launch.py", bag=str(write_bag(tmp_path / "1")), rate="0", namespace="b")
    with started(launched, at, tmp_path) as processes:
        processes["bag_replay"].wait_for_output("replayed 250 messages, 0 stalls")
        assert [process.interrupt() for process in processes.values()] == [0] * len(processes)
