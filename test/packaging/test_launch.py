# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The launch files start what exists, with parameters that exist."""

import ast
import re
from importlib.util import find_spec
from pathlib import Path

import pytest
from launch_stand_in import ArgumentError, Launched, Started, run

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.config.files import read_parameters
from msss_graphslam.core.recipes import ESTIMATORS

ROOT = Path(__file__).parents[2]
SLAM = "slam.launch.py"
REPLAY = "replay.launch.py"
SLAM_NODES = ["dead_reckoning", "scan_generation", "front_end", "back_end"]


def executables() -> tuple[str, ...]:
    """Return the nodes that setup.py installs."""
    tree = ast.parse((ROOT / "setup.py").read_text(encoding="utf-8"))
    for statement in tree.body:
        if isinstance(statement, ast.Assign) and ast.unparse(statement.targets[0]) == "NODES":
            return tuple(ast.literal_eval(statement.value))
    raise LookupError("setup.py has no NODES")


def declarations(module: str, visited: set[str]) -> str:
    """Return the source of a module and of what it imports of nodes and their base."""
    visited.add(module)
    path = ROOT / module.replace(".", "/")
    path = path / "__init__.py" if path.is_dir() else path.with_suffix(".py")
    source = path.read_text(encoding="utf-8")
    imported = re.findall(r"^from (msss_graphslam\.(?:nodes|ros)[\w.]*) import", source, re.M)
    return source + "".join(declarations(m, visited) for m in imported if m not in visited)


def names(launched: Launched) -> list[str]:
    return [node.executable for node in launched.nodes]


def started(launched: Launched, name: str) -> Started:
    (node,) = (node for node in launched.nodes if node.executable == name)
    return node


@pytest.fixture(params=[SLAM, REPLAY])
def everything(request: pytest.FixtureRequest) -> Launched:
    """Each launch file with all it can start."""
    return run(request.param, bag="pond", record="dive.mcap", sonar="raw")


@pytest.mark.parametrize("name", executables())
def test_every_executable_has_its_module(name: str) -> None:
    tree = ast.parse((ROOT / f"msss_graphslam/nodes/{name}.py").read_text(encoding="utf-8"))
    functions = {node.name for node in tree.body if isinstance(node, ast.FunctionDef)}
    assert "main" in functions


def test_every_argument_is_described(everything: Launched) -> None:
    assert everything.arguments
    bare = [argument.name for argument in everything.arguments if not argument.description]
    assert bare == []


def test_only_installed_executables_are_started(everything: Launched) -> None:
    assert set(names(everything)) <= set(executables())


def test_every_parameter_is_one_that_the_node_declares(everything: Launched) -> None:
    for node in everything.nodes:
        source = declarations(f"msss_graphslam.nodes.{node.executable}", set())
        for name in set(node.parameters) - {"use_sim_time"}:
            assert re.search(rf'"{name}"', source), f"{node.executable}: {name}"


def test_every_parameter_file_holds_the_configuration(everything: Launched) -> None:
    files = {path for node in everything.nodes for path in node.files}
    defaults = {info.name: info.default for info in Configuration.parameters()}
    assert [read_parameters(path) for path in files] == [defaults]


def test_the_estimators_are_those_of_the_package(everything: Launched) -> None:
    choices = [a.choices for a in everything.arguments if a.name == "estimator"]
    assert all(sorted(found or []) == sorted(ESTIMATORS) for found in choices)
    with pytest.raises(ArgumentError, match="estimator"):
        run(SLAM, estimator="orb")


def test_live_there_is_no_replay_and_nothing_is_recorded_unasked() -> None:
    launched = run(SLAM)
    assert names(launched) == SLAM_NODES
    assert {node.parameters["use_sim_time"] for node in launched.nodes} == {False}
    assert {node.parameters.get("estimator", "full") for node in launched.nodes} == {"full"}
    assert started(launched, "back_end").parameters["output"] == ""


def test_what_is_asked_for_reaches_the_nodes() -> None:
    launched = run(SLAM, record="dive.mcap", output="out", namespace="auv", estimator="uspic")
    assert names(launched) == [*SLAM_NODES, "bag_recorder"]
    assert started(launched, "bag_recorder").parameters["output"] == "dive.mcap"
    assert started(launched, "back_end").parameters["output"] == "out"
    assert started(launched, "front_end").parameters["estimator"] == "uspic"
    assert {node.namespace for node in launched.nodes} == {"auv"}


def test_the_driver_of_the_head_is_started_when_asked_for() -> None:
    assert "micron_driver" not in names(run(SLAM, sonar="none"))
    launched = run(SLAM, sonar="micron", namespace="auv")
    assert names(launched) == ["micron_driver", *SLAM_NODES]
    driver = started(launched, "micron_driver")
    assert (driver.parameters, driver.namespace) == ({"use_sim_time": False}, "auv")
    with pytest.raises(ArgumentError, match="sonar"):
        run(SLAM, sonar="ping360")


def test_recorded_bytes_go_through_the_driver() -> None:
    launched = run(REPLAY, bag="pond", sonar="raw")
    assert names(launched) == ["micron_driver", *SLAM_NODES, "bag_replay"]
    assert started(launched, "micron_driver").parameters == {
        "use_sim_time": True,
        "source": "topic",
    }
    with pytest.raises(ArgumentError, match="sonar"):
        run(REPLAY, bag="pond", sonar="micron")


def test_a_replay_runs_on_its_own_clock_and_ends_everything() -> None:
    launched = run(REPLAY, bag="pond", rate="20", loop="True", namespace="auv", output="out")
    assert names(launched) == [*SLAM_NODES, "bag_replay"]
    replay = started(launched, "bag_replay")
    assert replay.parameters == {"bag": "pond", "rate": 20.0, "start_offset": 0.0, "loop": True}
    assert isinstance(replay.parameters["rate"], float)
    assert [node.executable for node in launched.nodes if node.ends_all] == ["bag_replay"]
    assert all(started(launched, name).parameters["use_sim_time"] for name in SLAM_NODES)
    assert started(launched, "back_end").parameters["output"] == "out"
    assert started(launched, "back_end").parameters["recording"] == "pond"
    assert {node.namespace for node in launched.nodes} == {"auv"}


def test_a_replay_without_a_bag_is_refused() -> None:
    with pytest.raises(ArgumentError, match="bag"):
        run(REPLAY)


@pytest.mark.skipif(find_spec("launch_ros") is None, reason="ROS launch is not installed here")
@pytest.mark.parametrize("name", [SLAM, REPLAY])
def test_the_real_launch_takes_the_file(name: str) -> None:
    from launch import LaunchContext
    from launch.launch_description_sources import PythonLaunchDescriptionSource

    source = PythonLaunchDescriptionSource(str(ROOT / "launch" / name))
    description = source.get_launch_description(LaunchContext())
    assert all(argument.description for argument in description.get_launch_arguments())
