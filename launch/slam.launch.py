# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The live system: every node a process, and a recorder where one is asked for."""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.conditions import IfCondition
from launch.substitutions import (
    EqualsSubstitution,
    LaunchConfiguration,
    NotEqualsSubstitution,
    PathJoinSubstitution,
)
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue
from launch_ros.substitutions import FindPackageShare

PACKAGE = "msss_graphslam"
FILES = ("params_file", "more_params_file")


def generate_launch_description() -> LaunchDescription:
    """Return the nodes that make the corrected pose and the map from the sensors' topics."""
    estimating = {"estimator": given("estimator", str)}
    results = {"output": given("output", str), "recording": given("recording", str)}
    return LaunchDescription(
        [
            *arguments(),
            node("micron_driver", {}, condition=sonar_is("micron")),
            node("micron_driver", {"source": "topic"}, condition=sonar_is("raw")),
            node("dead_reckoning", {}),
            node("scan_generation", {}),
            node("front_end", estimating),
            node("back_end", {**estimating, **results}),
            node("bag_recorder", {"output": given("record", str)}, condition=is_given("record")),
        ]
    )


def arguments() -> list[DeclareLaunchArgument]:
    """Return what can be given on the command line."""
    defaults = PathJoinSubstitution([FindPackageShare(PACKAGE), "config", f"{PACKAGE}.yaml"])
    return [
        argument("namespace", "", "namespace of nodes and topics, one for each vehicle"),
        argument("params_file", defaults, "ROS parameter file with the configuration"),
        argument(
            "more_params_file",
            LaunchConfiguration("params_file"),
            "a second one, whose values go before those of the first",
        ),
        DeclareLaunchArgument(
            "estimator",
            default_value="full",
            description="estimator of trajectory and map",
            choices=["dead_reckoning", "uspic", "chen2015", "full"],
        ),
        DeclareLaunchArgument(
            "sonar",
            default_value="none",
            description="none: others publish sonar/ping; micron: micron_driver does, with the"
            " parameters of the group micron; raw: micron_driver makes it of sonar/raw",
            choices=["none", "micron", "raw"],
        ),
        argument("output", "", "folder into which ~/save of back_end writes; empty: no files"),
        argument("record", "", "bag for inputs and outputs; empty: nothing is recorded"),
        argument("recording", "", "the bag that is replayed, which the results then name"),
        argument("use_sim_time", "false", "take the time from /clock"),
    ]


def argument(name: str, default: object, description: str) -> DeclareLaunchArgument:
    """Return the declaration of an argument that may be left out."""
    return DeclareLaunchArgument(name, default_value=default, description=description)


def node(name: str, parameters: dict[str, object], **options: object) -> Node:
    """Return one of the package's nodes, with the configuration and parameters of its own."""
    timing = {"use_sim_time": given("use_sim_time", bool)}
    return Node(
        package=PACKAGE,
        executable=name,
        namespace=LaunchConfiguration("namespace"),
        parameters=[*map(LaunchConfiguration, FILES), {**timing, **parameters}],
        output="screen",
        **options,
    )


def given(name: str, kind: type) -> ParameterValue:
    """Return the value of an argument; a bag named 123 stays text."""
    return ParameterValue(LaunchConfiguration(name), value_type=kind)


def sonar_is(choice: str) -> IfCondition:
    """Return the condition that this is where the beams come from."""
    return IfCondition(EqualsSubstitution(LaunchConfiguration("sonar"), choice))


def is_given(name: str) -> IfCondition:
    """Return the condition that an argument is not empty."""
    return IfCondition(NotEqualsSubstitution(LaunchConfiguration(name), ""))
