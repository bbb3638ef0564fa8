# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Bad input: counted, told, survived; and the result is what the good input gives."""

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import pytest
from nodes.processes import Domain
from system.comparison import assert_same, refused
from system.faulty_messages import Change, clouds, reports, truncated, with_faults, without
from system.fleet import Fleet
from system.missions import Mission, altered
from system.witness import Witness

from msss_graphslam.messages import topics
from msss_graphslam.messages.topics import Topic
from msss_graphslam.nodes.names import SLAM_NODES
from msss_graphslam.ros.messages import make, message_class
from msss_graphslam.ros.qos import profile_of

pytestmark = pytest.mark.slow

_PARAMETERS = "rcl_interfaces/srv/SetParameters"


def test_faults_of_sensors_are_counted_as_the_offline_run_counts_them(
    pond: Mission, own_domain: Domain, tmp_path: Path
) -> None:
    faulty = altered(pond, tmp_path / "faulty", with_faults())
    counted = refused(faulty.offline)
    assert {"beam_not_finite", "beam_lengths_differ", "imu_not_finite"} <= set(counted)
    assert {"stamp_not_increasing", "stamp_jumps_ahead", "pressure_not_finite"} <= set(counted)
    with Fleet(own_domain, tmp_path / "live") as fleet, _everything(own_domain) as witness:
        fleet.start()
        fleet.run(faulty.bag, 0)
        _assert_all_heard_and_finite(witness)
    assert_same(fleet.output, faulty.offline)
    assert refused(fleet.output) == counted


def test_bytes_that_are_no_message_are_survived(
    pond: Mission, own_domain: Domain, tmp_path: Path
) -> None:
    faulty = altered(pond, tmp_path / "faulty", truncated)
    with Fleet(own_domain, tmp_path / "live") as fleet, _everything(own_domain) as witness:
        fleet.start()
        fleet.run(faulty.bag, 0)
        _assert_all_heard_and_finite(witness)
    assert_same(fleet.output, faulty.offline)


@pytest.mark.parametrize("missing", ["/imu/data", "/pressure"])
def test_a_missing_sensor_gives_what_the_offline_run_gives(
    pond: Mission, own_domain: Domain, tmp_path: Path, missing: str
) -> None:
    change: Change = without(missing)
    lacking = altered(pond, tmp_path / "lacking", change)
    with Fleet(own_domain, tmp_path / "live") as fleet, _everything(own_domain) as witness:
        fleet.start()
        fleet.run(lacking.bag, 0)
        _assert_all_heard_and_finite(witness)
    assert_same(fleet.output, lacking.offline)


def test_garbage_between_the_nodes_changes_nothing(
    pond: Mission, own_domain: Domain, tmp_path: Path
) -> None:
    with (
        Fleet(own_domain, tmp_path / "live") as fleet,
        Witness(own_domain, checked=topics.OUTPUTS) as witness,
    ):
        fleet.start()
        replay = fleet.replay(pond.bag, 20)
        witness.wait_for_keyframes(3)
        _shout(witness, topics.SCAN_BEAMS, clouds())
        _shout(witness, topics.GRAPH_POSES, clouds())
        _shout(witness, topics.SETTLED_ODOMETRY, clouds())
        _shout(witness, topics.TRIED, reports())
        _shout(witness, topics.CORRECTION, [make("nav_msgs/msg/Odometry")])
        fleet.finish(replay)
        _assert_all_heard_and_finite(witness)
        for node, key in (
            ("front_end", "refused/scan_beams_size"),
            ("front_end", "refused/graph_poses_size"),
            ("back_end", "refused/scan_beams_size"),
            ("back_end", "refused/tried_names"),
            ("scan_generation", "refused/settled_odometry_size"),
        ):
            witness.wait_for_row(node, key)
    assert_same(fleet.output, pond.offline)


def test_a_second_publisher_is_not_followed(
    pond: Mission, own_domain: Domain, tmp_path: Path
) -> None:
    with Fleet(own_domain, tmp_path / "live") as fleet, Witness(own_domain) as witness:
        fleet.start()
        replay = fleet.replay(pond.bag, 20)
        witness.wait_for_keyframes(3)
        ping = make(
            topics.SONAR_PING.type_name,
            ranges=[1.0, 2.0],
            intensities=[10.0, 200.0],
            range_max=9.0,
        )
        _shout(witness, topics.SONAR_PING, [ping] * 5)
        fleet.finish(replay)
        witness.wait_for_row("dead_reckoning", "not_used/sonar/ping", 5)
        witness.wait_for_row("scan_generation", "refused/second_publisher", 5)
    assert_same(fleet.output, pond.offline)


def test_a_clock_that_jumps_back_changes_nothing(
    pond: Mission, own_domain: Domain, tmp_path: Path
) -> None:
    with Fleet(own_domain, tmp_path / "live") as fleet, _everything(own_domain) as witness:
        fleet.start(use_sim_time=True)
        replay = fleet.replay(pond.bag, 20)
        witness.wait_for_keyframes(3)
        _shout(witness, Topic("/clock", "rosgraph_msgs/msg/Clock"), [_clock(5), _clock(0)] * 5)
        fleet.finish(replay)
        _assert_all_heard_and_finite(witness)
    assert_same(fleet.output, pond.offline)


def test_parameters_out_of_range(own_domain: Domain, tmp_path: Path) -> None:
    changes = {
        "dead_reckoning": ("dead_reckoning.compass_noise", -1.0),
        "front_end": ("matching.overlap", 7.0),
    }
    file = tmp_path / "wrong.yaml"
    file.write_text(
        "/**:\n  ros__parameters:\n    dead_reckoning:\n      surge_noise: -3.0\n"
        "    matching:\n      overlap: .nan\n      iteratoins: 5\n    sensors: {patience: soon}\n",
        encoding="utf-8",
    )
    with Fleet(own_domain, tmp_path / "live") as fleet, Witness(own_domain) as witness:
        fleet.start(arguments=["--params-file", str(file)])
        for node, (name, value) in changes.items():
            result = _set(witness, node, name, value)
            assert not result.successful
            assert name in result.reason
        for node in SLAM_NODES:
            assert witness.call(message_class("std_srvs/srv/Trigger"), f"/{node}/reset").success
            assert fleet.nodes[node].is_running
        fleet.nodes["dead_reckoning"].wait_for_output("surge_noise.*0.03 is used")
        fleet.nodes["front_end"].wait_for_output("overlap.*0.5 is used")
        fleet.nodes["front_end"].wait_for_output("iteratoins")


def _everything(domain: Domain) -> Witness:
    # No driver runs here.
    links = (link for link in topics.LINKS if link is not topics.RAW_TAKEN)
    return Witness(domain, checked=(*topics.OUTPUTS, *links))


def _assert_all_heard_and_finite(witness: Witness) -> None:
    assert not witness.offences[:5]
    assert not witness.missing


def _shout(witness: Witness, topic: Topic, messages: Iterable[Any]) -> None:
    """Publish the messages as a second publisher of the topic; all have arrived at the end."""
    kind = message_class(topic.type_name)
    publisher = witness.node.create_publisher(kind, topic.name, profile_of(topic, 100))
    witness.wait_until_matched(publisher)
    for message in messages:
        publisher.publish(message)
    witness.wait_until_taken(publisher)


def _set(witness: Witness, node: str, name: str, value: float) -> Any:
    """Return the result of ``ros2 param set``."""
    given = make("rcl_interfaces/msg/ParameterValue", type=3, double_value=value)
    parameter = make("rcl_interfaces/msg/Parameter", name=name, value=given)
    answer = witness.call(
        message_class(_PARAMETERS), f"/{node}/set_parameters", parameters=[parameter]
    )
    return answer.results[0]


def _clock(seconds: int) -> Any:
    return make("rosgraph_msgs/msg/Clock", clock=make("builtin_interfaces/msg/Time", sec=seconds))
