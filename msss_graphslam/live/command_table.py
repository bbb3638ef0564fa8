# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Which processes ``msss live`` starts, and with which parameters."""

import json
import signal
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.config.files import ros_parameters
from msss_graphslam.live.process import Command
from msss_graphslam.nodes.names import AWAITED, DRIVER, RECORDER, REPLAY, SLAM_NODES

__all__ = ["Setup", "command_table", "saving_order"]

_Value = str | float | bool | list[str]


@dataclass(frozen=True, slots=True)
class Setup:
    """What to run: on the sensors' topics, or on a recording in their place.

    A recording is replayed at ``rate`` times real time, 0 as fast as it goes. With ``driver`` the
    beams come from a Micron's head, or of a recording from the bytes that it sent.
    """

    output: Path
    estimator: str
    configuration: Configuration
    replay: Path | None = None
    rate: float = 1.0
    record: Path | None = None
    namespace: str = ""
    driver: bool = False


def saving_order(setup: Setup) -> tuple[str, ...]:
    """Return the nodes that save, in the order in which data goes through them."""
    return (DRIVER, *SLAM_NODES) if setup.driver else SLAM_NODES


def command_table(setup: Setup, folder: Path) -> list[Command]:
    """Return the commands in the order to start them; their parameter files go into ``folder``."""
    shared = folder / "configuration.yaml"
    shared.write_text(ros_parameters(setup.configuration), encoding="utf-8")
    commands = [_command(name, setup, folder) for name in saving_order(setup)]
    if setup.record is not None:
        commands.append(_command(RECORDER, setup, folder))
    if setup.replay is not None:
        commands.append(_command(REPLAY, setup, folder))
    return commands


def _command(name: str, setup: Setup, folder: Path) -> Command:
    own = folder / f"{name}.yaml"
    own.write_text(_parameter_file(_parameters(name, setup)), encoding="utf-8")
    arguments = [sys.executable, "-m", f"msss_graphslam.nodes.{name}", "--ros-args"]
    for path in (folder / "configuration.yaml", own):
        arguments += ["--params-file", str(path)]
    if setup.namespace:
        arguments += ["-r", f"__ns:=/{setup.namespace.strip('/')}"]
    return Command(
        name,
        tuple(arguments),
        returns=name != REPLAY,
        orphaned=signal.SIGTERM if name == RECORDER else signal.SIGKILL,
    )


def _parameters(name: str, setup: Setup) -> dict[str, _Value]:
    """Return the parameters that a node has beside the configuration."""
    values: dict[str, _Value] = {"use_sim_time": setup.replay is not None}
    if name in SLAM_NODES:
        values["estimator"] = setup.estimator
    if name == "back_end":
        values["output"] = str(setup.output.resolve())
        if setup.replay is not None:
            values["recording"] = str(setup.replay.resolve())
    if name == REPLAY and setup.replay is not None:
        values |= {"bag": str(setup.replay.resolve()), "rate": setup.rate, "conclude": False}
        values["wait_for"] = _listeners(setup)
    if name == DRIVER and setup.replay is not None:
        values["source"] = "topic"
    if name == RECORDER and setup.record is not None:
        values["output"] = str(setup.record.resolve())
    return values


def _listeners(setup: Setup) -> list[str]:
    """Return the nodes that a replay has to wait for."""
    return [DRIVER] * setup.driver + [*AWAITED] + [RECORDER] * (setup.record is not None)


def _parameter_file(values: Mapping[str, _Value]) -> str:
    """Return a ROS parameter file for whichever node reads it.

    JSON's scalars are YAML's: text is always quoted, so that a bag named 123 stays text, and a
    float has its point.
    """
    lines = [
        f"    {name}: {json.dumps(value, ensure_ascii=False)}" for name, value in values.items()
    ]
    return "\n".join(["/**:", "  ros__parameters:", *lines]) + "\n"
