# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What the nodes tell each other comes back as it was."""

from collections.abc import Callable
from dataclasses import replace
from importlib.util import find_spec
from math import nan
from typing import Any

import numpy as np
import pytest
from link_examples import (
    CORRECTION,
    GRAPH,
    MESSAGES,
    POSE,
    REPORT,
    SCAN,
    SETTLED,
    STAMP,
    TRACK,
    leaves,
)
from made_scans import BEAMS

from msss_graphslam.core.types import GraphPoses
from msss_graphslam.messages import encoding, link_decoding
from msss_graphslam.recordings.typestore import TYPES, decode, make


def assert_equal(record: Any, expected: Any) -> None:
    found, wanted = list(leaves(record)), list(leaves(expected))
    assert len(found) == len(wanted)
    for one, other in zip(found, wanted, strict=True):
        assert type(one) is type(other)
        np.testing.assert_array_equal(one, other)
        if isinstance(one, np.ndarray):
            assert one.dtype == other.dtype


@pytest.fixture(params=["typestore", "rclpy"])
def through(request: pytest.FixtureRequest) -> Callable[[str], Any]:
    """What decodes the named message after it has been bytes, with one of both makers."""
    if request.param == "typestore":
        return lambda name: MESSAGES[name][2](
            decode(
                bytes(TYPES.serialize_cdr(MESSAGES[name][0](make), MESSAGES[name][1])),
                MESSAGES[name][1],
            )
        )
    if find_spec("rclpy") is None:
        pytest.skip("needs rclpy")
    from rclpy.serialization import deserialize_message, serialize_message

    from msss_graphslam.ros import messages

    def sent(name: str) -> Any:
        build, type_name, read = MESSAGES[name]
        data = serialize_message(build(messages.make))
        return read(deserialize_message(data, messages.message_class(type_name)))

    return sent


def test_settled_odometry_comes_back(through: Callable[[str], Any]) -> None:
    settled = through("settled")
    assert settled.stamp_ns == STAMP + 7
    assert_equal(settled.entries, tuple(SETTLED))


def test_a_scan_comes_back_to_the_bit(through: Callable[[str], Any]) -> None:
    assert 0 < len(SCAN.beam_index) < BEAMS
    assert_equal(through("scan"), SCAN)


def test_a_report_comes_back(through: Callable[[str], Any]) -> None:
    assert_equal(through("tried"), REPORT)


def test_the_graph_comes_back(through: Callable[[str], Any]) -> None:
    assert_equal(through("graph"), GRAPH)


def test_a_correction_comes_back_but_for_the_quaternion(through: Callable[[str], Any]) -> None:
    found = through("correction")
    np.testing.assert_allclose(found.pose, CORRECTION.pose, rtol=0, atol=1e-12)
    assert_equal(replace(found, pose=CORRECTION.pose), CORRECTION)


def test_poses_come_back(through: Callable[[str], Any]) -> None:
    for name in ("pose", "path"):
        found = through(name)
        assert found.stamp_ns == (STAMP if name == "pose" else STAMP + 2 * 10**9)
        np.testing.assert_allclose(found.pose, POSE, rtol=0, atol=1e-12)
    whole = through("whole path")
    assert [placed.stamp_ns for placed in whole] == TRACK.stamps_ns.tolist()


def test_nothing_settled_and_no_keyframes_come_back() -> None:
    settled = link_decoding.settled_odometry(encoding.settled_odometry(make, STAMP, []))
    assert (settled.stamp_ns, settled.entries) == (STAMP, ())
    empty = GraphPoses(np.empty(0, np.int64), *np.empty((2, 0, 3)), np.empty((0, 3, 3)))
    assert_equal(link_decoding.graph_poses(encoding.graph_poses(make, empty)), empty)
    first = replace(REPORT, number=0, constraints=())
    assert_equal(link_decoding.tried(encoding.tried(make, first)), first)


def test_a_beam_with_two_points_is_not_encoded() -> None:
    twice = replace(SCAN, beam_index=np.zeros_like(SCAN.beam_index))
    with pytest.raises(ValueError, match="more than one point"):
        encoding.scan_beams(make, twice)


def test_a_figure_that_is_not_finite_is_left_out() -> None:
    edge = replace(REPORT.constraints[1], figures={"shift": nan, "overlap": 0.5})
    report = link_decoding.tried(encoding.tried(make, replace(REPORT, constraints=(edge,))))
    assert report.constraints[0].figures == {"overlap": 0.5}


def test_columns_are_read_by_name_in_any_order_and_byte_order() -> None:
    message = MESSAGES["graph"][0](make)
    layout = np.dtype(
        {
            "names": [field.name for field in message.fields],
            "formats": ["i4", "u4", "3f8", "3f8", "9f8"],
            "offsets": [field.offset for field in message.fields],
        }
    )
    rows = message.data.view(layout)
    turned = np.dtype([(name, layout[name].newbyteorder(">")) for name in reversed(layout.names)])
    other = np.zeros(len(rows), turned)
    for name in layout.names:
        other[name] = rows[name]
    message.data = np.frombuffer(other.tobytes(), np.uint8)
    message.is_bigendian = True
    for field in message.fields:
        field.offset = turned.fields[field.name][1]
    assert_equal(link_decoding.graph_poses(message), GRAPH)
