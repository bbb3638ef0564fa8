# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The package in a colcon workspace: built, installed, started, tested."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from nodes.processes import domain
from rclpy.executors import SingleThreadedExecutor

ROOT = Path(__file__).parents[2]
COLCON = Path(sys.executable).with_name("colcon")
PACKAGED = ["config", "launch", "msss_graphslam", "resource", "test/packaging"]
PACKAGED += ["package.xml", "pyproject.toml", "setup.cfg", "setup.py"]
SLAM_NODES = ["dead_reckoning", "scan_generation", "front_end", "back_end"]
FAST_TESTS = ["test/packaging/test_views.py"]
FOUND = """
import msss_graphslam
from ament_index_python import get_package_share_directory

print(msss_graphslam.__file__)
print(get_package_share_directory("msss_graphslam"))
"""

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not COLCON.exists(), reason="colcon is not installed here"),
]


@pytest.fixture(scope="module")
def environment() -> Iterator[dict[str, str]]:
    """What a shell has in which the environment is active, alone in its ROS domain."""
    with domain() as own:
        yield {
            **own.environment,
            "VIRTUAL_ENV": sys.prefix,
            "PATH": os.pathsep.join([str(COLCON.parent), os.environ["PATH"]]),
            "AMENT_PREFIX_PATH": os.environ.get("AMENT_PREFIX_PATH", sys.prefix),
            "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1",
        }


@pytest.fixture(scope="module")
def workspace(tmp_path_factory: pytest.TempPathFactory, environment: dict[str, str]) -> Path:
    """A workspace with the package built in it."""
    workspace = tmp_path_factory.mktemp("workspace")
    source = workspace / "src" / "msss_graphslam"
    for name in PACKAGED:
        (source / name).parent.mkdir(parents=True, exist_ok=True)
        (source / name).symlink_to(ROOT / name)
    finish([COLCON, "build", "--packages-select", "msss_graphslam"], workspace, environment)
    return workspace


def finish(command: list[Path | str], workspace: Path, environment: dict[str, str]) -> str:
    """Run a command that must succeed in the workspace; return what it prints."""
    done = subprocess.run(
        command,
        cwd=workspace,
        env=environment,
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def sourced(*command: Path | str) -> list[Path | str]:
    """Return the command as it runs where the workspace is sourced."""
    return ["bash", "-c", '. install/setup.bash && exec "$0" "$@"', *command]


@pytest.fixture
def start(
    workspace: Path, environment: dict[str, str]
) -> Iterator[Callable[..., subprocess.Popen[str]]]:
    """Starts an installed executable as ``ros2 run`` does; ends with the test."""
    processes = []

    def start(name: str, *arguments: str) -> subprocess.Popen[str]:
        executable = workspace / "install/msss_graphslam/lib/msss_graphslam" / name
        process = subprocess.Popen(
            sourced(executable, *arguments),
            cwd=workspace,
            env=environment,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
        )
        processes.append(process)
        return process

    yield start
    for process in processes:
        process.kill()
        process.communicate()


def wait_for_diagnostics(nodes: dict[str, subprocess.Popen[str]], domain: int) -> None:
    """Return when each of the nodes has said how it stands, or one has ended or none speaks."""
    missing = {f"/{name}" for name in nodes}
    context = rclpy.Context()
    rclpy.init(context=context, domain_id=domain)
    try:
        node = rclpy.create_node("listener", context=context)
        executor = SingleThreadedExecutor(context=context)
        executor.add_node(node)

        def take(message: DiagnosticArray) -> None:
            missing.difference_update(status.name for status in message.status)

        node.create_subscription(DiagnosticArray, "/diagnostics", take, 100)
        until = time.monotonic() + 60.0
        while missing and time.monotonic() < until and all_run(nodes):
            executor.spin_once(timeout_sec=0.1)
    finally:
        rclpy.shutdown(context=context)
    assert ended(nodes) == {}
    assert missing == set()


def all_run(nodes: dict[str, subprocess.Popen[str]]) -> bool:
    return all(process.poll() is None for process in nodes.values())


def ended(nodes: dict[str, subprocess.Popen[str]]) -> dict[str, str]:
    """Return what the nodes that are no more have said last."""
    return {
        name: process.stderr.read() if process.stderr else ""
        for name, process in nodes.items()
        if process.poll() is not None
    }


def test_the_workspace_has_the_package_and_not_the_repository(
    workspace: Path, environment: dict[str, str]
) -> None:
    module, share = finish(sourced("python", "-c", FOUND), workspace, environment).split()
    assert Path(module).is_relative_to(workspace / "install")
    assert Path(share) == workspace / "install/msss_graphslam/share/msss_graphslam"
    for folder in ("config", "launch"):
        files = {path.name for path in (ROOT / folder).iterdir() if path.is_file()}
        assert {path.name for path in (Path(share) / folder).iterdir()} == files


def test_every_node_starts_speaks_and_ends_by_ctrl_c(
    start: Callable[..., subprocess.Popen[str]],
    environment: dict[str, str],
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
) -> None:
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    nodes = {name: start(name) for name in SLAM_NODES}
    recorder = ["--ros-args", "-p", f"output:={tmp_path / 'dive.mcap'}"]
    nodes["bag_recorder"] = start("bag_recorder", *recorder)
    wait_for_diagnostics(nodes, int(environment["ROS_DOMAIN_ID"]))
    for process in nodes.values():
        process.send_signal(signal.SIGINT)
    assert {name: process.wait(timeout=60) for name, process in nodes.items()} == dict.fromkeys(
        nodes, 0
    )


def test_a_replay_without_a_bag_says_what_is_missing(
    start: Callable[..., subprocess.Popen[str]],
) -> None:
    process = start("bag_replay")
    _, errors = process.communicate(timeout=60)
    assert process.returncode == 1
    assert "parameter bag is missing" in errors
    assert "Traceback" not in errors


def test_the_tests_pass_under_colcon(workspace: Path, environment: dict[str, str]) -> None:
    options = ["--return-code-on-test-failure", "--pytest-args", *FAST_TESTS]
    finish([COLCON, "test", *options], workspace, environment)
    assert (workspace / "build/msss_graphslam/pytest.xml").exists()
