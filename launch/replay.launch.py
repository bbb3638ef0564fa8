# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""A recording in place of the sensors; ends when the nodes have worked off all of it."""

import json
import subprocess
from tempfile import NamedTemporaryFile

from launch import LaunchContext, LaunchDescription
from launch.actions import (
    DeclareLaunchArgument,
    IncludeLaunchDescription,
    OpaqueFunction,
    Shutdown,
)
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue
from launch_ros.substitutions import FindPackageShare

PACKAGE = "msss_graphslam"
REPLAY = {"bag": str, "rate": float, "start_offset": float, "loop": bool}
LISTENING = ["dead_reckoning", "scan_generation", "back_end"]
SLAM = ("namespace", "params_file", "estimator", "sonar", "output", "record")


def generate_launch_description() -> LaunchDescription:
    """Return the live system on simulated time, and the replay that feeds it."""
    share = FindPackageShare(PACKAGE)
    return LaunchDescription(
        [
            *replay_arguments(),
            *slam_arguments(share),
            OpaqueFunction(function=system),
            replay(),
        ]
    )


def system(context: LaunchContext) -> list[IncludeLaunchDescription]:
    """Return the live system, with what only the bag knows where nobody gives it."""
    bag, given, sonar = (
        LaunchConfiguration(name).perform(context) for name in ("bag", "params_file", "sonar")
    )
    asked = about(bag, given)
    slam = PathJoinSubstitution([FindPackageShare(PACKAGE), "launch", "slam.launch.py"])
    handed_on = {name: LaunchConfiguration(name) for name in SLAM}
    replayed = {
        "use_sim_time": "true",
        "recording": bag,
        "sonar": asked["sonar"] if sonar == "auto" else sonar,
        "more_params_file": file_of(asked["parameters"]) or given,
    }
    source = PythonLaunchDescriptionSource(slam)
    launch_arguments = {**handed_on, **replayed}.items()
    return [IncludeLaunchDescription(source, launch_arguments=launch_arguments)]


def about(bag: str, parameters: str) -> dict[str, str]:
    """Return what the bag adds to a file of parameters, and where its beams come from.

    The Python of the nodes is asked: that of ``ros2 launch`` need not have what reads bags.
    """
    command = ["python3", "-m", "msss_graphslam.live.replayed", bag, parameters]
    done = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=False)  # noqa: S603
    return json.loads(done.stdout) if done.stdout else {"sonar": "none", "parameters": ""}


def file_of(parameters: str) -> str:
    """Return a file that lasts as long as the nodes may read it; without parameters none."""
    if not parameters:
        return ""
    with NamedTemporaryFile("w", prefix="msss_replay_", suffix=".yaml", delete=False) as file:
        file.write(parameters)
    return file.name


def replay_arguments() -> list[DeclareLaunchArgument]:
    """Return what concerns the replay."""
    return [
        DeclareLaunchArgument("bag", description="an mcap file or a rosbag2 folder"),
        argument("rate", "1.0", "mission seconds a second; 0: as fast as it goes"),
        argument("start_offset", "0.0", "what is left out at the beginning [s]"),
        argument("loop", "false", "begin anew at the end, the nodes reset before each lap"),
    ]


def slam_arguments(share: FindPackageShare) -> list[DeclareLaunchArgument]:
    """Return what is handed on to the live system."""
    defaults = PathJoinSubstitution([share, "config", f"{PACKAGE}.yaml"])
    return [
        argument("namespace", "", "namespace of nodes and topics, one for each vehicle"),
        argument("params_file", defaults, "ROS parameter file with the configuration"),
        DeclareLaunchArgument(
            "estimator",
            default_value="full",
            description="estimator of trajectory and map",
            choices=["dead_reckoning", "uspic", "chen2015", "full"],
        ),
        DeclareLaunchArgument(
            "sonar",
            default_value="auto",
            description="none: the bag has sonar/ping; raw: it has sonar/raw only, which"
            " micron_driver decodes; auto: what the bag has",
            choices=["auto", "none", "raw"],
        ),
        argument("output", "", "folder for the files of the result; empty: no files"),
        argument("record", "", "bag for inputs and outputs; empty: nothing is recorded"),
    ]


def argument(name: str, default: object, description: str) -> DeclareLaunchArgument:
    """Return the declaration of an argument that may be left out."""
    return DeclareLaunchArgument(name, default_value=default, description=description)


def replay() -> Node:
    """Return the replay; its end is everybody's."""
    parameters = {
        name: ParameterValue(LaunchConfiguration(name), value_type=kind)
        for name, kind in REPLAY.items()
    }
    parameters["wait_for"] = LISTENING
    return Node(
        package=PACKAGE,
        executable="bag_replay",
        namespace=LaunchConfiguration("namespace"),
        parameters=[parameters],
        output="screen",
        on_exit=Shutdown(reason="the replay has ended"),
    )
