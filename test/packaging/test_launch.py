# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The launch files start what exists, with parameters that exist."""

import ast
import re
from importlib.util import find_spec
from pathlib import Path

import pytest
import yaml
from launch_stand_in import ArgumentError, Launched, Started, run
from sample_bags import START_NS, beam_message, write_bag

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.config.files import read_parameters
from msss_graphslam.core.recipes import ESTIMATORS
from msss_graphslam.nodes.names import AWAITED
from msss_graphslam.recordings.mounting import Mounting

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
    assert replay.parameters == {
        "bag": "pond",
        "rate": 20.0,
        "start_offset": 0.0,
        "loop": True,
        "wait_for": list(AWAITED),
    }
    assert isinstance(replay.parameters["rate"], float)
    assert [node.executable for node in launched.nodes if node.ends_all] == ["bag_replay"]
    assert all(started(launched, name).parameters["use_sim_time"] for name in SLAM_NODES)
    assert started(launched, "back_end").parameters["output"] == "out"
    assert started(launched, "back_end").parameters["recording"] == "pond"
    assert {node.namespace for node in launched.nodes} == {"auv"}


@pytest.mark.parametrize("given", [{}, {"mount_x": 0.4}, {"mount_y": 0.0}])
def test_a_replay_takes_the_mounting_that_nobody_gives_from_the_bag(
    tmp_path: Path, given: dict[str, float]
) -> None:
    static = Mounting(0.2, -0.1, 0.5).transforms(START_NS)
    ping = ("/sonar/ping", beam_message(0), START_NS)
    bag = write_bag(tmp_path / "dive", [("/tf_static", static, START_NS), ping])
    own = tmp_path / "vehicle.yaml"
    own.write_text(
        yaml.safe_dump({"/**": {"ros__parameters": {"port": "/dev/a", "sonar": given}}})
    )
    launched = run(REPLAY, bag=str(bag), params_file=str(own))
    for name in SLAM_NODES:
        first, second = started(launched, name).files
        assert first == own
        found = {**read_parameters(first), **read_parameters(second)}
        expected = {"sonar.mount_x": 0.2, "sonar.mount_y": -0.1, "sonar.mount_yaw": 0.5}
        if given.get("mount_x"):
            expected["sonar.mount_x"] = 0.4
        assert found == {"port": "/dev/a", **expected}
    second.unlink()


@pytest.mark.parametrize("bag", [str(ROOT / "bags" / "pond"), "nothing"])
def test_a_replay_whose_bag_tells_no_mounting_has_the_given_file_alone(bag: str) -> None:
    first, second = started(run(REPLAY, bag=bag), "scan_generation").files
    assert first == second


@pytest.mark.parametrize(("sonar", "decoded"), [("auto", True), ("raw", True), ("none", False)])
def test_a_bag_of_bytes_alone_gets_the_driver_unasked(sonar: str, decoded: bool) -> None:
    launched = run(REPLAY, bag=str(ROOT / "bags" / "pond"), sonar=sonar)
    assert ("micron_driver" in names(launched)) is decoded
    assert names(launched) == names(run(REPLAY, bag=str(ROOT / "bags" / "pond"))) or not decoded


def test_a_bag_with_beams_has_no_driver(tmp_path: Path) -> None:
    assert "micron_driver" not in names(run(REPLAY, bag=str(write_bag(tmp_path / "dive"))))


@pytest.mark.parametrize("name", [SLAM, REPLAY])
def test_the_python_of_ros2_launch_need_not_have_the_package(name: str) -> None:
    tree = ast.parse((ROOT / "launch" / name).read_text(encoding="utf-8"))
    imported = [node.module for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)]
    assert {str(module).partition(".")[0] for module in imported} <= {
        "launch",
        "launch_ros",
        "tempfile",
    }


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
