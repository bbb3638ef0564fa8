# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""How topics are delivered: nothing on one machine may be lost silently.

Reliable does not protect from a short history, so the depth exceeds the longest stall times the
rate. Above 5000 the middleware loses messages without a word.
"""

from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy

from msss_graphslam.messages.topics import Topic

__all__ = ["DEEP", "LARGEST_DEPTH", "LATCHED", "LATCHED_DEEP", "STREAM", "name_of", "profile_of"]

DEEP = 2000
LARGEST_DEPTH = 5000

# One for all vehicles of a domain, whatever the node's namespace.
_ABSOLUTE = ("clock", "diagnostics", "tf", "tf_static")


def _reliable(depth: int, latched: bool) -> QoSProfile:
    durability = DurabilityPolicy.TRANSIENT_LOCAL if latched else DurabilityPolicy.VOLATILE
    return QoSProfile(
        history=HistoryPolicy.KEEP_LAST,
        depth=min(depth, LARGEST_DEPTH),
        reliability=ReliabilityPolicy.RELIABLE,
        durability=durability,
    )


STREAM = _reliable(DEEP, latched=False)
LATCHED = _reliable(1, latched=True)
LATCHED_DEEP = _reliable(DEEP, latched=True)


def profile_of(topic: Topic, depth: int | None = None) -> QoSProfile:
    """Return a profile of its own for the topic: rclpy writes overrides into what it is given.

    Without a depth a latched topic keeps one message, a stream as many as fit safely.
    """
    if depth is None:
        depth = 1 if topic.latched else DEEP
    return _reliable(depth, topic.latched)


def name_of(topic: Topic) -> str:
    """Return the name to subscribe and publish under: relative, but for those of all nodes."""
    return topic.absolute if topic.name in _ABSOLUTE else topic.name
