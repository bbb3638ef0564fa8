# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Messages cast as bytes are those that rclpy would have made."""

from typing import Any

import numpy as np
import pytest
from rclpy.serialization import deserialize_message

from msss_graphslam.core.types import Odometry
from msss_graphslam.messages import encoding
from msss_graphslam.ros.messages import make, message_class
from msss_graphslam.ros.moulds import Mould

ODOMETRY = "nav_msgs/msg/Odometry"


def reckoned(seed: int) -> Odometry:
    rng = np.random.default_rng(seed)
    stamp_ns = int(rng.integers(2**60))
    numbers = [rng.normal(size=size) for size in (6, (6, 6), 6, (6, 6))]
    return Odometry(stamp_ns, *numbers)


def numbers_of(message: Any) -> np.ndarray:
    """The 85 numbers of an Odometry, by their names."""
    place, turn = message.pose.pose.position, message.pose.pose.orientation
    twist = message.twist.twist
    return np.array(
        [
            *(place.x, place.y, place.z, turn.x, turn.y, turn.z, turn.w),
            *message.pose.covariance,
            *(twist.linear.x, twist.linear.y, twist.linear.z),
            *(twist.angular.x, twist.angular.y, twist.angular.z),
            *message.twist.covariance,
        ]
    )


@pytest.mark.parametrize("frame", ["", "o", "od", "odo", "odom", "left/odom", "näher"])
@pytest.mark.parametrize("child", ["", "b", "ba", "bas", "base_link"])
def test_a_cast_message_is_the_one_that_is_made_of_its_parts(frame: str, child: str) -> None:
    mould = Mould(encoding.odometry(make, reckoned(1), frame, child), 85)
    wanted = encoding.odometry(make, reckoned(2), frame, child)
    mould.numbers[:] = numbers_of(wanted)
    cast = deserialize_message(mould.cast(reckoned(2).stamp_ns), message_class(ODOMETRY))
    assert cast == wanted


def test_what_was_cast_stays_when_the_next_is() -> None:
    mould = Mould(encoding.odometry(make, reckoned(1)), 85)
    first = mould.cast(5)
    mould.numbers[0] += 1.0
    second = mould.cast(1_500_000_000)
    assert first != second
    kind = message_class(ODOMETRY)
    assert deserialize_message(first, kind).header.stamp.nanosec == 5
    assert deserialize_message(second, kind).header.stamp.sec == 1


def test_more_numbers_than_the_message_has_are_refused() -> None:
    with pytest.raises(ValueError, match="CDR"):
        Mould(make("std_msgs/msg/Header", frame_id="map"), 3)
