# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What the nodes tell each other: nothing hostile gets through."""

from collections.abc import Callable
from copy import deepcopy
from enum import Enum
from math import inf, nan
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from link_examples import MESSAGES, leaves

from msss_graphslam.messages import Refusal
from msss_graphslam.recordings.typestore import TYPES, UndecodableError, decode, make


def assert_finite(record: Any) -> None:
    for leaf in leaves(record):
        assert isinstance(leaf, str | Enum) or np.isfinite(leaf).all()


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
