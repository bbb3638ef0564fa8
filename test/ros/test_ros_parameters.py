# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Parameters of a real node: given at the start, changed while it runs, described."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from msss_graphslam.config.configuration import Configuration

pytest.importorskip("rclpy")

from rclpy.node import Node
from rclpy.parameter import Parameter

from msss_graphslam.ros.messages import make, message_class
from msss_graphslam.ros.parameters import Parameters

Start = Callable[..., Any]
GROUPS = ("dead_reckoning", "sensors")


class Configured:
    def __init__(self, graph: Any) -> None:
        self.changes: list[Configuration] = []
        self.node = graph.add(Node("reckoner", namespace="/red"))
        self.parameters = Parameters(self.node, GROUPS, ("dead_reckoning",), self.changes.append)

    def set(self, **values: Any) -> Any:
        """Set parameters at once, with ``__`` for the point in their names."""
        pairs = [Parameter(name.replace("__", "."), value=v) for name, v in values.items()]
        return self.node.set_parameters_atomically(pairs)


def given(*assignments: str) -> list[str]:
    return [part for assignment in assignments for part in ("-p", assignment)]


def test_without_parameters_the_defaults_hold(graph: Any) -> None:
    configured = Configured(graph)
    assert configured.parameters.configuration == Configuration()
    assert configured.parameters.problems == []
    names = {info.name for info in Configuration.parameters()}
    declared = {name for name in names if configured.node.has_parameter(name)}
    assert declared == {name for name in names if name.partition(".")[0] in GROUPS}


def test_a_file_for_all_nodes_is_read(started: Start, tmp_path: Path) -> None:
    path = tmp_path / "all.yaml"
    path.write_text(
        "/**:\n  ros__parameters:\n    dead_reckoning:\n      patience: 20\n"
        "    mapping:\n      resolution: 0.5\n"
    )
    configured = Configured(started("--params-file", str(path)))
    assert configured.parameters.configuration.dead_reckoning.patience == 20.0
    assert configured.node.get_parameter("dead_reckoning.patience").value == 20.0
    assert configured.parameters.problems == []


@pytest.mark.parametrize(
    ("assignment", "problem"),
    [
        (
            "patience:=1000.0",
            "dead_reckoning.patience = 1000.0: must lie in [0.1, 600]; 2.0 is used",
        ),
        ("patience:=fast", "dead_reckoning.patience = 'fast': must be of type float; 2.0 is used"),
        ("patience:=[1.0, 2.0]", "must be of type float; 2.0 is used"),
        ("patience:=.nan", "must lie in [0.1, 600]; 2.0 is used"),
        ("patience:=true", "dead_reckoning.patience = True: must be of type float; 2.0 is used"),
        ("depth_noise:=.inf", "dead_reckoning.depth_noise = inf: must be finite; 0.02 is used"),
        ("patiense:=3.0", "unknown parameter 'dead_reckoning.patiense'; did you mean"),
    ],
)
def test_what_cannot_be_used_leaves_the_default(
    started: Start, assignment: str, problem: str
) -> None:
    configured = Configured(started(*given(f"dead_reckoning.{assignment}")))
    assert configured.parameters.configuration == Configuration()
    (told,) = configured.parameters.problems
    assert problem in told


def test_a_change_is_handed_over_once_and_whole(graph: Any) -> None:
    configured = Configured(graph)
    assert configured.set(dead_reckoning__patience=3, dead_reckoning__surge_speed=0.5).successful
    (changed,) = configured.changes
    assert changed == configured.parameters.configuration
    assert (changed.dead_reckoning.patience, changed.dead_reckoning.surge_speed) == (3.0, 0.5)
    assert configured.node.get_parameter("dead_reckoning.patience").value == 3.0


@pytest.mark.parametrize(
    ("values", "reason"),
    [
        ({"dead_reckoning__patience": 700.0}, "out of range"),
        ({"dead_reckoning__depth_noise": -1.0}, "must lie in [1e-06, inf]"),
        ({"dead_reckoning__depth_noise": float("inf")}, "must be finite"),
        ({"dead_reckoning__patience": "fast"}, "Wrong parameter type"),
        ({"sensors__water_density": 1025.0}, "read-only"),
        ({"dead_reckoning__surge_speed": 0.5, "dead_reckoning__depth_noise": 0.0}, "must lie in"),
    ],
)
def test_a_bad_change_is_refused_with_its_reason(
    graph: Any, values: dict[str, Any], reason: str
) -> None:
    configured = Configured(graph)
    result = configured.set(**values)
    assert not result.successful
    assert reason in result.reason
    assert configured.parameters.configuration == Configuration()
    assert configured.changes == []


def test_a_service_call_with_an_integer_is_read_as_a_float(graph: Any) -> None:
    """As in ``ros2 param set /red/reckoner dead_reckoning.patience 3``."""
    configured = Configured(graph)
    kind = message_class("rcl_interfaces/srv/SetParameters")
    client = configured.node.create_client(kind, "/red/reckoner/set_parameters")
    value = make("rcl_interfaces/msg/ParameterValue", type=2, integer_value=3)
    name = "dead_reckoning.patience"
    request = kind.Request(
        parameters=[make("rcl_interfaces/msg/Parameter", name=name, value=value)]
    )
    (result,) = graph.answer(client, request).results
    assert result.successful, result.reason
    assert configured.changes[0].dead_reckoning.patience == 3.0


def test_parameters_of_others_are_left_alone(graph: Any) -> None:
    configured = Configured(graph)
    assert configured.set(use_sim_time=True).successful
    assert configured.changes == []


def test_descriptors_tell_meaning_unit_range_and_source(graph: Any) -> None:
    node = Configured(graph).node
    surge = node.describe_parameter("dead_reckoning.surge_speed")
    assert surge.description == "assumed forward speed while no DVL speaks [m/s] (eq. 6, u_k)"
    (limits,) = surge.floating_point_range
    assert (limits.from_value, limits.to_value, surge.read_only) == (-5.0, 5.0, False)
    noise = node.describe_parameter("dead_reckoning.depth_noise")
    assert noise.additional_constraints == "[1e-06, inf]"
    assert list(noise.floating_point_range) == []
    assert node.describe_parameter("sensors.water_density").read_only


@pytest.mark.parametrize(
    ("assignments", "rate", "told"),
    [
        ([], 10.0, 0),
        (["rate:=20"], 20.0, 0),
        (["rate:=-1.0"], 10.0, 1),
        (["rate:=soon"], 10.0, 1),
    ],
)
def test_a_node_may_have_parameters_of_its_own(
    started: Start, assignments: list[str], rate: float, told: int
) -> None:
    configured = Configured(started(*given(*assignments)))
    found = configured.parameters.declare("rate", 10.0, "how often [Hz]", minimum=0.1, maximum=100)
    assert (type(found), found) == (float, rate)
    assert configured.node.get_parameter("rate").value == rate
    assert len(configured.parameters.problems) == told
    assert not configured.set(rate=30.0).successful


class Flat:
    """A node whose group ``sensors`` has parameters without the group's name."""

    def __init__(self, graph: Any) -> None:
        self.changes: list[Configuration] = []
        self.node = graph.add(Node("driver"))
        self.parameters = Parameters(
            self.node, ("sensors",), ("sensors",), self.changes.append, flat=("sensors",)
        )


def test_a_flat_group_is_declared_by_short_names_alone(graph: Any) -> None:
    flat = Flat(graph)
    assert flat.node.get_parameter("water_density").value == 1000.0
    assert not flat.node.has_parameter("sensors.water_density")
    assert flat.node.set_parameters_atomically([Parameter("water_density", value=1025)]).successful
    assert flat.parameters.configuration.sensors.water_density == 1025.0
    assert [changed.sensors.water_density for changed in flat.changes] == [1025.0]


@pytest.mark.parametrize(
    ("assignments", "density"),
    [
        (("water_density:=1020.0",), 1020.0),
        (("sensors.water_density:=1010.0",), 1010.0),
        (("sensors.water_density:=1010.0", "water_density:=1020.0"), 1020.0),
        (("water_density:=1020.0", "sensors.water_density:=1010.0"), 1020.0),
    ],
)
def test_a_flat_group_takes_the_full_name_of_a_file_too(
    started: Start, assignments: tuple[str, ...], density: float
) -> None:
    flat = Flat(started(*given(*assignments)))
    assert flat.parameters.configuration.sensors.water_density == density
    assert flat.node.get_parameter("water_density").value == density
    assert flat.parameters.problems == []


@pytest.mark.parametrize(
    ("assignment", "problem"),
    [
        ("water_density:=1.0", "water_density = 1.0: must lie in [900, 1100]; 1000.0 is used"),
        ("sensors.water_density:=1.0", "water_density = 1.0: must lie in [900, 1100]; 1000.0"),
        ("sensors.water_densiti:=1.0", "unknown parameter 'sensors.water_densiti'; did you mean"),
    ],
)
def test_a_bad_value_of_a_flat_group_is_told(
    started: Start, assignment: str, problem: str
) -> None:
    flat = Flat(started(*given(assignment)))
    assert flat.parameters.configuration == Configuration()
    (told,) = flat.parameters.problems
    assert problem in told


def test_a_bad_change_of_a_flat_group_is_refused_by_its_short_name(graph: Any) -> None:
    flat = Flat(graph)
    result = flat.node.set_parameters_atomically([Parameter("water_density", value="salt")])
    assert not result.successful
    patience = flat.node.set_parameters_atomically([Parameter("patience", value=0.1)])
    assert not patience.successful
    assert flat.changes == []
