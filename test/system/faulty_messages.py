# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Messages as broken sensors and broken links send them."""

from collections.abc import Callable, Iterable, Iterator
from itertools import cycle
from math import nan
from typing import Any

import numpy as np

from msss_graphslam.recordings.mcap_reading import RawMessage
from msss_graphslam.recordings.typestore import TYPES
from msss_graphslam.ros.messages import make

__all__ = ["Change", "clouds", "reports", "truncated", "with_faults", "without"]

Change = Callable[[int, RawMessage], Iterable[RawMessage]]

_EVERY = 40
_BACK = 30


def with_faults() -> Change:
    """Return a change that puts broken messages after good ones, in every way in turn."""
    ways = {topic: cycle(breaks) for topic, breaks in _WAYS.items()}

    def change(number: int, raw: RawMessage) -> Iterator[RawMessage]:
        yield raw
        if number % _EVERY == 0 and raw.channel.topic in ways:
            yield _broken(raw, next(ways[raw.channel.topic]))

    return change


def truncated(number: int, raw: RawMessage) -> Iterator[RawMessage]:
    """Put the first half of its bytes after some of the messages."""
    yield raw
    if number % _EVERY == 0 and raw.channel.topic in _WAYS:
        yield raw._replace(data=raw.data[: len(raw.data) // 2])


def without(*topics: str) -> Change:
    """Return a change that leaves topics out."""

    def change(_number: int, raw: RawMessage) -> Iterable[RawMessage]:
        return [] if raw.channel.topic in topics else [raw]

    return change


def clouds() -> Iterator[Any]:
    """Yield clouds in the place of a link's: empty, of senseless sizes, of senseless fields."""
    kind, field = "sensor_msgs/msg/PointCloud2", "sensor_msgs/msg/PointField"
    yield make(kind)
    yield make(kind, height=1, width=4_000_000_000, point_step=4_000_000_000)
    yield make(kind, height=1, width=3, point_step=0, data=b"\x01\x02\x03")
    fields = [make(field, name=name, offset=2**31, datatype=8, count=6) for name in ("sec", "x")]
    yield make(kind, height=1, width=2, point_step=8, fields=fields, data=bytes(16))
    generator = np.random.default_rng(1)
    for width in (1, 7, 100):
        data = generator.integers(0, 256, 64 * width, dtype=np.uint8)
        yield make(kind, height=1, width=width, point_step=64, fields=fields, data=data)


def reports() -> Iterator[Any]:
    """Yield arrays in the place of a keyframe's report."""
    kind, status = "diagnostic_msgs/msg/DiagnosticArray", "diagnostic_msgs/msg/DiagnosticStatus"
    pair = "diagnostic_msgs/msg/KeyValue"
    yield make(kind)
    for name in ("", "keyframe_x", "keyframe_-1", "keyframe_999999999999", "keyframe_2"):
        yield make(kind, status=[make(status, name=name)])
    values = [make(pair, key=key, value="nan inf 1e999") for key in ("pose", "odometry")]
    yield make(kind, status=[make(status, name="keyframe_3", values=values)])


def _broken(raw: RawMessage, way: Callable[[Any], None]) -> RawMessage:
    assert raw.schema is not None
    message = TYPES.deserialize_cdr(raw.data, raw.schema.name)
    way(message)
    return raw._replace(data=bytes(TYPES.serialize_cdr(message, raw.schema.name)))


def _not_turning(message: Any) -> None:
    message.angular_velocity.z = nan


def _without_direction(message: Any) -> None:
    message.orientation.w = nan


def _silent(message: Any) -> None:
    message.fluid_pressure = nan


def _crushed(message: Any) -> None:
    message.fluid_pressure = 1e300


def _deaf(message: Any) -> None:
    message.intensities = np.full_like(message.intensities, nan)


def _too_short(message: Any) -> None:
    message.intensities = message.intensities[:-3].copy()


def _empty(message: Any) -> None:
    message.ranges = message.intensities = np.zeros(0, dtype=np.float32)


def _of_long_ago(message: Any) -> None:
    message.header.stamp.sec -= _BACK


def _of_the_future(message: Any) -> None:
    message.header.stamp.sec += 3600


_WAYS: dict[str, list[Callable[[Any], None]]] = {
    "/imu/data": [_not_turning, _without_direction, _of_long_ago, _of_the_future],
    "/pressure": [_silent, _crushed, _of_long_ago],
    "/sonar/ping": [_deaf, _too_short, _empty, _of_long_ago, _of_the_future],
}
