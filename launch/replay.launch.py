# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""A recording in place of the sensors; ends when the nodes have worked off all of it."""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, IncludeLaunchDescription, Shutdown
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue
from launch_ros.substitutions import FindPackageShare

PACKAGE = "msss_graphslam"
REPLAY = {"bag": str, "rate": float, "start_offset": float, "loop": bool}
SLAM = ("namespace", "params_file", "estimator", "sonar", "output", "record")


def generate_launch_description() -> LaunchDescription:
    """Return the live system on simulated time, and the replay that feeds it."""
    share = FindPackageShare(PACKAGE)
    slam = PathJoinSubstitution([share, "launch", "slam.launch.py"])
    handed_on = {name: LaunchConfiguration(name) for name in SLAM}
    replayed = {"use_sim_time": "true", "recording": LaunchConfiguration("bag")}
    return LaunchDescription(
        [
            *replay_arguments(),
            *slam_arguments(share),
            IncludeLaunchDescription(
                PythonLaunchDescriptionSource(slam),
                launch_arguments={**handed_on, **replayed}.items(),
            ),
            replay(),
        ]
    )


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
            default_value="none",
            description="none: the bag has sonar/ping; raw: it has sonar/raw only, which"
            " micron_driver decodes",
            choices=["none", "raw"],
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
    return Node(
        package=PACKAGE,
        executable="bag_replay",
        namespace=LaunchConfiguration("namespace"),
        parameters=[parameters],
        output="screen",
        on_exit=Shutdown(reason="the replay has ended"),
    )
