# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""One input of a node: from the middleware's message to a record in order."""

from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from time import monotonic
from typing import Any

from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.exceptions import ParameterException
from rclpy.node import Node
from rclpy.qos import HistoryPolicy, QoSPolicyKind, QoSProfile, qos_policy_name_from_kind
from rclpy.qos_overriding_options import InvalidQosOverridesError, QoSOverridingOptions
from rclpy.subscription import Subscription

from msss_graphslam.messages.refusal import Refusal
from msss_graphslam.messages.topics import Topic
from msss_graphslam.ros.diagnostics import Diagnostics, Finding, Level
from msss_graphslam.ros.faults import Faults
from msss_graphslam.ros.messages import make, message_class
from msss_graphslam.ros.publisher_watch import PublisherWatch
from msss_graphslam.ros.qos import DEEP, LARGEST_DEPTH, name_of, profile_of
from msss_graphslam.ros.stamp_watch import StampWatch

__all__ = ["Input", "Rules"]

_OVERRIDABLE = (
    QoSPolicyKind.HISTORY,
    QoSPolicyKind.DEPTH,
    QoSPolicyKind.RELIABILITY,
    QoSPolicyKind.DURABILITY,
)
_SILENCE = 2.0
_RESULT = "rcl_interfaces/msg/SetParametersResult"


@dataclass(frozen=True, slots=True)
class Rules:
    """What is asked of an input.

    ``ordered``: its stamps increase. ``single``: it has one publisher. ``required``: silence is an
    error. ``pausable``: what comes while the node pauses is dropped and counted. ``shared``:
    another node hears the same and counts what is refused of it; this one only shows how many.
    """

    ordered: bool = True
    single: bool = False
    required: bool = False
    pausable: bool = True
    shared: bool = False


class Input:
    """A subscription whose messages are decoded, checked, counted and taken one by one."""

    def __init__(
        self,
        node: Node,
        topic: Topic,
        decode: Callable[[Any], Any],
        take: Callable[[Any], None],
        rules: Rules,
        diagnostics: Diagnostics,
        faults: Faults,
        is_paused: Callable[[], bool],
    ) -> None:
        self.topic = topic
        self._node = node
        self._decode = decode
        self._take = take
        self._rules = rules
        self._diagnostics = diagnostics
        self._faults = faults
        self._is_paused = is_paused
        self._refused: Counter[str] = Counter() if rules.shared else diagnostics.refused
        if rules.shared:
            diagnostics.values[f"not_used/{topic.name}"] = self._refused.total
        self._watch = diagnostics.input(topic.name)
        self._stamps = StampWatch(topic.name)
        self._misfit = ""
        self.subscription = self._subscribe()
        self._publishers = PublisherWatch(self.publishers, exclusive=rules.single)
        self._checks = [self._clock, self._silence, self._quality, self._several]
        diagnostics.checks += self._checks

    def close(self) -> None:
        """Subscribe no more, and say no more of it."""
        self._node.destroy_subscription(self.subscription)
        self._diagnostics.forget(self.topic.name)
        for check in self._checks:
            self._diagnostics.checks.remove(check)

    def reset(self) -> None:
        """Start anew: whatever comes next is in order."""
        self._stamps.reset()
        self._misfit = ""

    def publishers(self) -> int:
        """Return how many publish on the topic."""
        return int(self._node.count_publishers(self.subscription.topic_name))

    def _receive(self, message: Any, info: dict[str, int]) -> None:
        """Take one message or count why not; never raises."""
        stamp_ns = None
        try:
            number = info["publication_sequence_number"]
            self._watch.lost += self._publishers.check(number, monotonic())
            record = self._decoded(message)
            stamp_ns = getattr(record, "stamp_ns", None)
            self._check(stamp_ns)
        except Refusal as refusal:
            self._refused[refusal.reason] += 1
            self._watch.seen()
            return
        self._watch.seen(stamp_ns)
        try:
            self._take(record)
        except Refusal as refusal:
            self._diagnostics.refused[refusal.reason] += 1
        except Exception as error:
            self._faults.note(error, self.topic.name)

    def _decoded(self, message: Any) -> Any:
        try:
            return self._decode(message)
        except Refusal:
            raise
        except Exception as error:
            raise Refusal(f"{self.topic.label}_undecodable") from error

    def _check(self, stamp_ns: int | None) -> None:
        if self._rules.pausable and self._is_paused():
            raise Refusal("paused")
        if self._rules.ordered and stamp_ns is not None:
            self._stamps.check(stamp_ns)

    def _subscribe(self) -> Subscription:
        options = QoSOverridingOptions(_OVERRIDABLE, callback=_within_limits)
        try:
            return self._subscribed(options)
        except (InvalidQosOverridesError, ParameterException, RuntimeError) as error:
            problem = f"qos_overrides of {self.topic.name} not used: {error}"
            self._node.get_logger().error(problem)
            self._diagnostics.checks.append(lambda: Finding(Level.ERROR, problem))
            return self._subscribed(None)

    def _subscribed(self, options: QoSOverridingOptions | None) -> Subscription:
        # rclpy declares one argument; a callback with two is given the message's information.
        receive: Any = self._receive
        return self._node.create_subscription(
            message_class(self.topic.type_name),
            name_of(self.topic),
            receive,
            profile_of(self.topic, DEEP),
            event_callbacks=SubscriptionEventCallbacks(
                message_lost=self._lost, incompatible_qos=self._incompatible
            ),
            qos_overriding_options=options,
        )

    def _lost(self, event: Any) -> None:
        # The middleware does not tell of a history that was overrun: numbers do, if there are any.
        if not self._publishers.numbered:
            self._watch.lost += int(event.total_count_change)

    def _incompatible(self, event: Any) -> None:
        policy = qos_policy_name_from_kind(event.last_policy_kind).removesuffix("_QOS_POLICY")
        override = f"qos_overrides.{self.subscription.topic_name}.subscription.{policy.lower()}"
        self._misfit = (
            f"a publisher on {self.topic.name} has a {policy} that does not fit and is not heard;"
            f" set the parameter {override}"
        )
        self._node.get_logger().error(self._misfit)

    def _clock(self) -> Finding | None:
        complaint = self._stamps.complaint
        return Finding(Level.WARN, complaint) if complaint else None

    def _silence(self) -> Finding | None:
        silence = self._watch.silence
        if not self._rules.required or silence <= _SILENCE:
            return None
        return Finding(Level.ERROR, f"no input on {self.topic.name} for {silence:.0f} s")

    def _quality(self) -> Finding | None:
        return Finding(Level.ERROR, self._misfit) if self._misfit else None

    def _several(self) -> Finding | None:
        count = self.publishers() if self._rules.single else 1
        if count <= 1:
            return None
        return Finding(Level.WARN, f"{count} publishers on {self.topic.name}")


def _within_limits(profile: QoSProfile) -> Any:
    if profile.history == HistoryPolicy.KEEP_ALL or not 0 < profile.depth <= LARGEST_DEPTH:
        reason = f"history must be keep_last with a depth of 1 to {LARGEST_DEPTH}"
        return make(_RESULT, successful=False, reason=reason)
    return make(_RESULT, successful=True)
