# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The processes of a live run and the parameter files that they get."""

import signal
from pathlib import Path
from typing import Any

import pytest
import yaml

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.live.command_table import Setup, command_table, saving_order
from msss_graphslam.nodes.names import SLAM_NODES


def own_parameters(folder: Path, name: str) -> dict[str, Any]:
    content = yaml.safe_load((folder / f"{name}.yaml").read_text(encoding="utf-8"))
    parameters = content["/**"]["ros__parameters"]
    assert isinstance(parameters, dict)
    return parameters


def setup_of(tmp_path: Path, **values: Any) -> Setup:
    return Setup(tmp_path / "out", "full", Configuration(), **values)


def test_the_sensors_alone_need_the_four_nodes(tmp_path: Path) -> None:
    commands = command_table(setup_of(tmp_path), tmp_path)
    assert tuple(command.name for command in commands) == SLAM_NODES
    assert all(command.returns for command in commands)
    assert own_parameters(tmp_path, "back_end") == {
        "use_sim_time": False,
        "estimator": "full",
        "output": str(tmp_path / "out"),
    }


def test_the_replay_comes_last_and_runs_once(tmp_path: Path) -> None:
    setup = setup_of(tmp_path, replay=tmp_path / "123", rate=20.0, record=tmp_path / "new")
    commands = command_table(setup, tmp_path)
    assert [command.name for command in commands[4:]] == ["bag_recorder", "bag_replay"]
    assert [command.returns for command in commands] == [True] * 5 + [False]
    assert [command.orphaned for command in commands[4:]] == [signal.SIGTERM, signal.SIGKILL]
    assert own_parameters(tmp_path, "bag_replay") == {
        "use_sim_time": True,
        "bag": str(tmp_path / "123"),
        "rate": 20.0,
        "conclude": False,
        "wait_for": ["dead_reckoning", "scan_generation", "back_end", "bag_recorder"],
    }
    assert own_parameters(tmp_path, "bag_recorder")["output"] == str(tmp_path / "new")
    assert own_parameters(tmp_path, "back_end")["recording"] == str(tmp_path / "123")


def test_a_replay_waits_for_those_that_would_miss_its_beginning(tmp_path: Path) -> None:
    command_table(setup_of(tmp_path, replay=tmp_path), tmp_path)
    listening = ["dead_reckoning", "scan_generation", "back_end"]
    assert own_parameters(tmp_path, "bag_replay")["wait_for"] == listening


def test_the_driver_of_the_head_comes_first_and_takes_the_source_of_the_configuration(
    tmp_path: Path,
) -> None:
    setup = setup_of(tmp_path, driver=True)
    commands = command_table(setup, tmp_path)
    assert [command.name for command in commands] == ["micron_driver", *SLAM_NODES]
    assert saving_order(setup) == ("micron_driver", *SLAM_NODES)
    assert commands[0].returns
    assert own_parameters(tmp_path, "micron_driver") == {"use_sim_time": False}


def test_in_a_replay_the_driver_reads_the_recorded_bytes(tmp_path: Path) -> None:
    setup = setup_of(tmp_path, replay=tmp_path, record=tmp_path / "new", driver=True)
    command_table(setup, tmp_path)
    assert own_parameters(tmp_path, "micron_driver") == {"use_sim_time": True, "source": "topic"}
    assert own_parameters(tmp_path, "bag_replay")["wait_for"] == [
        "micron_driver",
        "dead_reckoning",
        "scan_generation",
        "back_end",
        "bag_recorder",
    ]


def test_only_the_back_end_and_the_replay_know_the_bag(tmp_path: Path) -> None:
    command_table(setup_of(tmp_path, replay=tmp_path / "bag_x"), tmp_path)
    knowing = {path.stem for path in tmp_path.glob("*.yaml") if "bag_x" in path.read_text()}
    assert knowing == {"back_end", "bag_replay"}


@pytest.mark.parametrize("name", ["123", "1e5", "true", "null", "a: b # c", 'q"uote', "größe"])
def test_a_name_is_text_whatever_it_looks_like(tmp_path: Path, name: str) -> None:
    command_table(setup_of(tmp_path, replay=Path(name)), tmp_path)
    text = (tmp_path / "bag_replay.yaml").read_text(encoding="utf-8")
    assert own_parameters(tmp_path, "bag_replay")["bag"] == str(Path(name).resolve())
    assert '    bag: "' in text


def test_a_whole_rate_is_written_as_a_float(tmp_path: Path) -> None:
    command_table(setup_of(tmp_path, replay=tmp_path, rate=0.0), tmp_path)
    assert "    rate: 0.0\n" in (tmp_path / "bag_replay.yaml").read_text(encoding="utf-8")


def test_every_node_gets_the_configuration_and_its_own_file(tmp_path: Path) -> None:
    changed = Configuration().with_values({"sonar.mount_x": 0.25})
    commands = command_table(Setup(tmp_path, "uspic", changed, namespace="auv/a"), tmp_path)
    shared = yaml.safe_load((tmp_path / "configuration.yaml").read_text(encoding="utf-8"))
    assert shared["/**"]["ros__parameters"]["sonar"]["mount_x"] == 0.25
    for command in commands:
        assert command.arguments[1:4] == (
            "-m",
            f"msss_graphslam.nodes.{command.name}",
            "--ros-args",
        )
        files = [str(tmp_path / name) for name in ("configuration.yaml", f"{command.name}.yaml")]
        assert [entry for entry in command.arguments if entry.endswith(".yaml")] == files
        assert command.arguments[-2:] == ("-r", "__ns:=/auv/a")


def test_without_a_namespace_none_is_set(tmp_path: Path) -> None:
    assert not any(
        "__ns" in word
        for each in command_table(setup_of(tmp_path), tmp_path)
        for word in each.arguments
    )
