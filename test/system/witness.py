# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Hears what the nodes publish: diagnostics, keyframes, and every number that is not finite."""

from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np
from nodes.processes import Domain, TestNode, wait_until
from rclpy.duration import Duration

from msss_graphslam.messages import topics
from msss_graphslam.ros.messages import available, message_class
from msss_graphslam.ros.qos import name_of, profile_of

__all__ = ["Witness", "not_finite"]

_DIAGNOSTICS = topics.Topic("diagnostics", "diagnostic_msgs/msg/DiagnosticArray")
_WHOLE = ("std_msgs", "builtin_interfaces", "diagnostic_msgs")
"""Packages whose messages hold no floating-point numbers that matter."""


class Witness(TestNode):
    """A node of the test that follows the diagnostics, and looks at what is ``checked``.

    ``missing`` are the checked topics without a message so far, ``offences`` the places of
    numbers that are not finite.
    """

    def __init__(
        self, of: Domain, namespace: str = "/", *, checked: Iterable[topics.Topic] = ()
    ) -> None:
        super().__init__(of, "witness", namespace)
        self.rows: dict[str, dict[str, str]] = {}
        self.messages: dict[str, str] = {}
        self.keyframes = 0
        self.offences: list[str] = []
        self._namespace = namespace.rstrip("/")
        self._subscribe(_DIAGNOSTICS, self._diagnosed)
        self._subscribe(topics.KEYFRAMES, self._updated)
        self.missing = {topic.name for topic in checked if available(topic.type_name)}
        for topic in checked:
            self._subscribe(topic, lambda message, name=topic.name: self._check(name, message))

    def row(self, node: str, key: str) -> float:
        """The number under the key of a node's diagnostics; 0 where there is none."""
        try:
            return float(self.rows.get(f"{self._namespace}/{node}", {}).get(key, "0"))
        except ValueError:
            return 0.0

    def wait_for_row(self, node: str, key: str, least: float = 1.0) -> float:
        """Wait until the row has at least this value, and return it."""
        try:
            wait_until(lambda: self.row(node, key) >= least, f"{key} of {node}")
        except AssertionError as error:
            raise AssertionError(f"{error}; has {self.rows.get(f'/{node}')}") from None
        return self.row(node, key)

    def wait_for_keyframes(self, count: int) -> None:
        wait_until(lambda: self.keyframes >= count, f"keyframe {count}")

    def wait_until_matched(self, publisher: Any) -> None:
        """Wait until the publisher knows every subscription of the topic."""
        count = self.node.count_subscribers
        wait_until(
            lambda: publisher.get_subscription_count() >= max(count(publisher.topic_name), 1),
            f"listeners of {publisher.topic_name}",
        )

    def wait_until_taken(self, publisher: Any) -> None:
        """Wait until all that was published has arrived."""
        assert publisher.wait_for_all_acked(Duration(seconds=60.0))

    def _subscribe(self, topic: topics.Topic, take: Any) -> None:
        if available(topic.type_name):
            kind = message_class(topic.type_name)
            profile = profile_of(topic, 2000)
            self.node.create_subscription(kind, name_of(topic), take, profile)

    def _diagnosed(self, message: Any) -> None:
        for status in message.status:
            self.rows[status.name] = {entry.key: entry.value for entry in status.values}
            self.messages[status.name] = status.message

    def _updated(self, message: Any) -> None:
        self.keyframes = len(message.poses)

    def _check(self, name: str, message: Any) -> None:
        self.missing.discard(name)
        self.offences += [f"{name}: {place}" for place in not_finite(message)]


def not_finite(message: Any, place: str = "") -> Iterator[str]:
    """Yield the places in the message where a number is not finite.

    Points of a cloud are read by their fields; text is passed over.
    """
    if type(message).__name__ == "PointCloud2":
        yield from _in_cloud(message, place)
        return
    for name in message.get_fields_and_field_types():
        yield from _in_value(getattr(message, name), f"{place}.{name}")


def _in_value(value: Any, place: str) -> Iterator[str]:
    if isinstance(value, float) or (hasattr(value, "__array__") or hasattr(value, "typecode")):
        if not np.isfinite(np.asarray(value, dtype=float)).all():
            yield place
    elif isinstance(value, list | tuple):
        for number, entry in enumerate(value):
            yield from _in_value(entry, f"{place}[{number}]")
    elif hasattr(value, "get_fields_and_field_types"):
        yield from not_finite(value, place)


def _in_cloud(message: Any, place: str) -> Iterator[str]:
    data = np.frombuffer(bytes(message.data), dtype=np.uint8).reshape(-1, message.point_step)
    for field in message.fields:
        kind = {7: "<f4", 8: "<f8"}.get(field.datatype)
        if kind is None:
            continue
        size = np.dtype(kind).itemsize * field.count
        column = np.ascontiguousarray(data[:, field.offset : field.offset + size])
        if not np.isfinite(column.view(kind)).all():
            yield f"{place}.{field.name}"
