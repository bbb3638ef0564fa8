# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What the nodes tell each other: it comes back as it was, and nothing hostile gets through."""

from collections.abc import Callable, Iterator
from copy import deepcopy
from dataclasses import fields, is_dataclass, replace
from enum import Enum
from importlib.util import find_spec
from math import inf, nan
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from made_scans import BEAMS, standing_scan
from synthetic_scans import corridor

from msss_graphslam.core.scans.scan_generation import reckoned_scan
from msss_graphslam.core.types import (
    Constraint,
    ConstraintKind,
    GraphPoses,
    KeyframeReport,
    MapCorrection,
    Odometry,
    Scan,
    Trajectory,
    TwistError,
)
from msss_graphslam.messages import Refusal, encoding, link_decoding
from msss_graphslam.recordings.typestore import TYPES, UndecodableError, decode, make

CLOUD = "sensor_msgs/msg/PointCloud2"
ARRAY = "diagnostic_msgs/msg/DiagnosticArray"
STAMP = 1_700_000_000_123_456_789
RNG = np.random.default_rng(5)
ERROR = TwistError(RNG.normal(size=3) / 3.0, np.cov(RNG.normal(size=(3, 9))))


def spread(size: int) -> np.ndarray:
    root = RNG.normal(size=(size, size))
    return root @ root.T / 3.0


def entry(stamp_ns: int) -> Odometry:
    return Odometry(stamp_ns, RNG.normal(size=6), spread(6), RNG.normal(size=6), spread(6))


def moving_scan() -> Scan:
    """A scan under way, whose second half of beams has no echo."""
    scan = standing_scan(corridor(), np.zeros(3), np.array([1.0, 2.0, 0.3]), 3, RNG)
    hits = np.flatnonzero(np.diff(scan.beam_index, prepend=-1) > 0)
    hits = hits[scan.beam_index[hits] < BEAMS // 2]
    return reckoned_scan(
        beam_stamps_ns=scan.beam_stamps_ns + STAMP,
        end_stamp_ns=scan.end_stamp_ns + STAMP,
        reckoned=scan.reckoned + np.cumsum(RNG.normal(size=(BEAMS + 1, 6)) * 0.01, axis=0),
        twist_covariance=spread(3) * 1e-3,
        beam_index=scan.beam_index[hits],
        body_points=scan.body_points[hits],
        body_covariances=scan.body_covariances[hits],
        complete=False,
        usable=True,
    )


SETTLED = [entry(STAMP), entry(STAMP + 1), entry(STAMP + 10**10)]
SCAN = moving_scan()
REPORT = KeyframeReport(
    number=7,
    stamp_ns=STAMP,
    pose=RNG.normal(size=3) / 3.0,
    odometry=RNG.normal(size=3) / 3.0,
    twist_error=ERROR,
    constraints=(
        Constraint(ConstraintKind.CONSECUTIVE, 6, 7, RNG.normal(size=3), spread(3)),
        Constraint(
            ConstraintKind.LOOP, 0, 7, RNG.normal(size=3), spread(3), "too_far", {"shift": 1 / 3}
        ),
    ),
)
GRAPH = GraphPoses(
    stamps_ns=STAMP + np.arange(4) * 10**10,
    poses=RNG.normal(size=(4, 3)),
    odometry=RNG.normal(size=(4, 3)),
    covariances=np.array([spread(3) for _ in range(4)]),
)
CORRECTION = MapCorrection(STAMP, np.array([1 / 3, -2.0, 3.1]), spread(3), ERROR)
POSE = np.array([1 / 3, -2.0, 0.5, 0.1, -0.2, 3.0])
TRACK = Trajectory(STAMP + np.arange(3) * 10**9, np.array([POSE * 0.0, POSE * 0.5, POSE]))

Make = Callable[..., Any]
MESSAGES: dict[str, tuple[Callable[[Make], Any], str, Callable[[Any], Any]]] = {
    "settled": (
        lambda maker: encoding.settled_odometry(maker, STAMP + 7, SETTLED),
        CLOUD,
        link_decoding.settled_odometry,
    ),
    "scan": (lambda maker: encoding.scan_beams(maker, SCAN), CLOUD, link_decoding.scan_beams),
    "tried": (lambda maker: encoding.tried(maker, REPORT), ARRAY, link_decoding.tried),
    "graph": (lambda maker: encoding.graph_poses(maker, GRAPH), CLOUD, link_decoding.graph_poses),
    "correction": (
        lambda maker: encoding.correction(maker, CORRECTION),
        "nav_msgs/msg/Odometry",
        link_decoding.correction,
    ),
    "pose": (
        lambda maker: encoding.pose(maker, STAMP, POSE, spread(6)),
        "geometry_msgs/msg/PoseWithCovarianceStamped",
        link_decoding.stamped_pose,
    ),
    "path": (
        lambda maker: encoding.path(maker, TRACK),
        "nav_msgs/msg/Path",
        link_decoding.last_pose,
    ),
    "whole path": (
        lambda maker: encoding.path(maker, TRACK),
        "nav_msgs/msg/Path",
        link_decoding.path_poses,
    ),
}


def leaves(record: Any) -> Iterator[Any]:
    """Yield all that a record is made of."""
    if is_dataclass(record):
        for field in fields(record):
            yield from leaves(getattr(record, field.name))
    elif isinstance(record, tuple | list):
        for one in record:
            yield from leaves(one)
    elif isinstance(record, dict):
        yield from leaves(list(record.items()))
    else:
        yield record


def assert_equal(record: Any, expected: Any) -> None:
    found, wanted = list(leaves(record)), list(leaves(expected))
    assert len(found) == len(wanted)
    for one, other in zip(found, wanted, strict=True):
        assert type(one) is type(other)
        np.testing.assert_array_equal(one, other)
        if isinstance(one, np.ndarray):
            assert one.dtype == other.dtype


def assert_finite(record: Any) -> None:
    for leaf in leaves(record):
        assert isinstance(leaf, str | Enum) or np.isfinite(leaf).all()


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


def setting(name: str, value: Any) -> Callable[[Any], None]:
    def change(message: Any) -> None:
        *parents, last = name.split(".")
        for parent in parents:
            message = message[int(parent)] if parent.isdigit() else getattr(message, parent)
        setattr(message, last, value)

    return change


REFUSED = [
    ("settled", setting("height", 2), "settled_odometry_size"),
    ("settled", setting("width", 2), "settled_odometry_size"),
    ("settled", setting("point_step", 0), "settled_odometry_size"),
    ("settled", setting("point_step", 2**31), "settled_odometry_size"),
    ("settled", setting("fields", []), "settled_odometry_fields"),
    ("settled", setting("fields.2.name", "poses"), "settled_odometry_fields"),
    ("settled", setting("fields.2.count", 5), "settled_odometry_fields"),
    ("settled", setting("fields.2.datatype", 7), "settled_odometry_fields"),
    ("settled", setting("fields.2.offset", 2**31), "settled_odometry_fields"),
    ("settled", setting("header.stamp.sec", -1), "settled_odometry_stamp_invalid"),
    ("settled", setting("fields.0.offset", 4), "settled_odometry_stamps_not_increasing"),
    ("scan", setting("header.stamp.sec", 1), "scan_beams_stamp_differs"),
    ("tried", setting("status", []), "tried_without_keyframe"),
    ("tried", setting("status.0.name", "keyframe_-7"), "tried_names"),
    ("tried", setting("status.0.name", "keyframe_8"), "tried_names"),
    ("tried", setting("status.1.name", "keyframe_7 -> keyframe_7"), "tried_names"),
    ("tried", setting("status.1.name", "keyframe_6 -> keyframe_7\n"), "tried_names"),
    ("tried", setting("status.1.hardware_id", "guess"), "tried_kind"),
    ("tried", setting("status.1.level", 1), "tried_level"),
    ("tried", setting("status.2.message", ""), "tried_level"),
    ("tried", setting("status.0.values.0.key", "Pose"), "tried_values"),
    ("tried", setting("status.0.values.0.value", "1 2"), "tried_values"),
    ("tried", setting("status.0.values.0.value", "1 2 x"), "tried_values"),
    ("tried", setting("status.0.values.0.value", "1 2 nan"), "tried_not_finite"),
    ("tried", setting("status.2.values.2.value", "inf"), "tried_not_finite"),
    ("correction", setting("header.stamp.sec", -1), "correction_stamp_invalid"),
    ("correction", setting("pose.pose.position.x", nan), "correction_not_finite"),
    ("correction", setting("twist.twist.angular.z", inf), "correction_not_finite"),
    ("correction", setting("twist.covariance", np.full(36, nan)), "correction_not_finite"),
    ("correction", setting("pose.covariance", np.zeros(9)), "correction_covariance_size"),
    ("pose", setting("pose.pose.position.x", nan), "pose_not_finite"),
    ("path", setting("poses", []), "path_without_poses"),
    ("path", setting("poses.2.pose.position.x", nan), "path_not_finite"),
    ("whole path", setting("poses.1.header.stamp.sec", 1), "path_stamps_not_increasing"),
]


@pytest.mark.parametrize(("name", "change", "reason"), REFUSED)
def test_refused_by_reason(name: str, change: Callable[[Any], None], reason: str) -> None:
    build, _, read = MESSAGES[name]
    message = deepcopy(build(make))
    change(message)
    with pytest.raises(Refusal) as caught:
        read(message)
    assert caught.value.reason == reason


def one_number(column: str, value: float) -> Callable[[Any], None]:
    def change(message: Any) -> None:
        offset = next(field.offset for field in message.fields if field.name == column)
        message.data = message.data.copy()
        message.data[offset : offset + 8] = np.frombuffer(np.float64(value).tobytes(), np.uint8)

    return change


@pytest.mark.parametrize(
    ("name", "column", "value"),
    [
        ("settled", "pose", nan),
        ("settled", "twist_covariance", inf),
        ("graph", "covariance", nan),
        ("scan", "body_point", nan),
        ("scan", "reckoned", -inf),
        ("scan", "twist_covariance", 1e308),
    ],
)
def test_a_cloud_that_is_or_becomes_not_finite_is_refused(
    name: str, column: str, value: float
) -> None:
    build, _, read = MESSAGES[name]
    message = build(make)
    one_number(column, value)(message)
    with pytest.raises(Refusal) as caught:
        read(message)
    assert caught.value.reason.endswith("_not_finite")


@pytest.mark.parametrize("name", MESSAGES)
@settings(max_examples=200, deadline=None)
@given(data=st.data())
def test_no_bytes_make_an_exception_or_a_record_that_is_not_finite(
    name: str, data: st.DataObject
) -> None:
    build, type_name, read = MESSAGES[name]
    changed = bytearray(TYPES.serialize_cdr(build(make), type_name))
    places = st.integers(4, len(changed) - 1)
    for place in data.draw(st.lists(places, min_size=1, max_size=12)):
        changed[place] = data.draw(st.integers(0, 255))
    del changed[data.draw(st.just(len(changed)) | places) :]
    try:
        record = read(decode(bytes(changed), type_name))
    except (Refusal, UndecodableError):
        return
    assert_finite(record)


@pytest.mark.parametrize("name", ["settled", "scan", "graph"])
@settings(max_examples=200, deadline=None)
@given(data=st.data())
def test_no_numbers_in_a_cloud_make_one_that_is_not_finite(name: str, data: st.DataObject) -> None:
    build, _, read = MESSAGES[name]
    message = build(make)
    message.data = message.data.copy()
    numbers = st.floats(width=64) | st.sampled_from([1e308, -1e308, 1e200])
    places = st.integers(0, message.point_step // 4 - 2)
    for place in data.draw(st.lists(places, min_size=1, max_size=5)):
        word = np.frombuffer(np.float64(data.draw(numbers)).tobytes(), np.uint8)
        message.data[4 * place : 4 * place + 8] = word
    try:
        record = read(message)
    except Refusal:
        return
    assert_finite(record)
