# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""A subscription that asks of its publishers no more than they offer."""

from collections.abc import Callable, Iterable
from typing import Any

from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

from msss_graphslam.messages.topics import Topic
from msss_graphslam.ros.messages import message_class
from msss_graphslam.ros.qos import DEEP, profile_of

__all__ = ["FittingSubscription", "fitting"]

_SOON = 0.05


def fitting(topic: Topic, offered: Iterable[QoSProfile]) -> QoSProfile:
    """Return the strictest profile that fits all that are offered: without loss, if it may be."""
    profile = profile_of(topic, DEEP)
    for other in offered:
        if other.reliability == ReliabilityPolicy.BEST_EFFORT:
            profile.reliability = ReliabilityPolicy.BEST_EFFORT
        if other.durability == DurabilityPolicy.VOLATILE:
            profile.durability = DurabilityPolicy.VOLATILE
    return profile


class FittingSubscription:
    """Hears a topic serialised, and asks for less where a publisher offers less.

    ``take`` is given what comes, ``warn`` is told once where messages may be lost.
    """

    def __init__(
        self,
        node: Node,
        topic: Topic,
        name: str,
        take: Callable[[Any], None],
        warn: Callable[[str], object],
    ) -> None:
        self._node, self._topic, self._name = node, topic, name
        self._take, self._warn = take, warn
        self._clock = Clock(clock_type=ClockType.STEADY_TIME)
        self._timer: Any = None
        self._subscription = self._subscribed()

    def _subscribed(self) -> Any:
        full = self._node.resolve_topic_name(self._name)
        publishers = self._node.get_publishers_info_by_topic(full)
        profile = fitting(self._topic, (each.qos_profile for each in publishers))
        if profile.reliability == ReliabilityPolicy.BEST_EFFORT:
            self._warn(f"{self._name} is offered without a guarantee: some may be lost")
        kind = message_class(self._topic.type_name)
        events = SubscriptionEventCallbacks(incompatible_qos=self._note)
        return self._node.create_subscription(
            kind, self._name, self._take, profile, event_callbacks=events, raw=True
        )

    def _note(self, _event: object) -> None:
        """Have another subscription soon: within its own event one cannot be taken away."""
        if self._timer is None:
            self._timer = self._node.create_timer(_SOON, self._subscribe_anew, clock=self._clock)

    def _subscribe_anew(self) -> None:
        self._node.destroy_timer(self._timer)
        self._timer = None
        self._node.destroy_subscription(self._subscription)
        self._subscription = self._subscribed()
