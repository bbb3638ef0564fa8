# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The nodes that tell how far they have taken what a replay sends."""

from collections.abc import Callable
from contextlib import suppress
from typing import Any

from rclpy.node import Node
from rclpy.qos import DurabilityPolicy

from msss_graphslam.messages import link_decoding, topics
from msss_graphslam.messages.refusal import Refusal
from msss_graphslam.messages.topics import Topic
from msss_graphslam.nodes.replay.backlog import Backlog
from msss_graphslam.nodes.replay.lead import Lead, header_stamp_ns
from msss_graphslam.recordings.mcap_reading import RawMessage
from msss_graphslam.ros.messages import message_class
from msss_graphslam.ros.qos import profile_of

__all__ = ["Follower", "GraphFollower"]

_NEWEST = 10


class Follower:
    """Compares what was sent with the stamps on a topic of the node.

    Parameters
    ----------
    node
        The replay's node.
    topic
        Where the other node tells of its progress, a stamp at the beginning of each message.
    limit_ns
        How far it may be behind [ns of sensor time].
    note
        Called when it has come further.
    """

    def __init__(
        self, node: Node, topic: Topic, limit_ns: int, note: Callable[[], object]
    ) -> None:
        self._node = node
        self._topic = topic
        self._note = note
        self._lead = Lead(limit_ns)
        self._is_given_up = False
        profile = profile_of(topic, _NEWEST)
        profile.durability = DurabilityPolicy.VOLATILE
        kind = message_class(topic.type_name)
        node.create_subscription(kind, topic.name, self._take, profile, raw=True)

    @property
    def is_heard(self) -> bool:
        """Whether the node is there and has not been given up."""
        return self._is_there and not self._is_given_up

    @property
    def is_behind(self) -> bool:
        """Whether the replay has to wait for the node."""
        return self._lead.is_too_long and self.is_heard

    @property
    def is_through(self) -> bool:
        """Whether the node, if it is there, has taken all that was sent."""
        return self._lead.is_over or not self._is_there

    def sent(self, raw: RawMessage) -> None:
        """Note a message that the node takes."""
        self._lead.sent(raw.log_ns, raw.data)

    def sent_at(self, log_ns: int, stamp_ns: int) -> None:
        """Note a message of that stamp, which does not stand at its beginning."""
        self._lead.sent_at(log_ns, stamp_ns)

    def release(self) -> None:
        """Allow the limit once more from here, whatever the node says."""
        self._lead.release()

    def give_up(self) -> None:
        """Wait for it no more, until it tells something new."""
        self._is_given_up = True

    def restart(self) -> None:
        """Forget what was sent: the next message is the first."""
        self._lead.restart()

    @property
    def _is_there(self) -> bool:
        return bool(self._node.count_publishers(self._topic.name) > 0)

    def _take(self, data: Any) -> None:
        stamp_ns = header_stamp_ns(data)
        if stamp_ns is not None and self._lead.settled(stamp_ns):
            self._is_given_up = False
            self._note()


class GraphFollower:
    """Compares scans with the corrections that the front end makes of them; ``note`` as above."""

    def __init__(self, node: Node, note: Callable[[], object]) -> None:
        self._node = node
        self._note = note
        self._backlog = Backlog()
        self.restart = self._backlog.restart
        # Of scans all from now on; of corrections the newest, which may be out already.
        profile = profile_of(topics.SCAN_BEAMS, _NEWEST)
        profile.durability = DurabilityPolicy.VOLATILE
        kind = message_class(topics.SCAN_BEAMS.type_name)
        node.create_subscription(kind, topics.SCAN_BEAMS.name, self._take_scan, profile)
        profile = profile_of(topics.CORRECTION, _NEWEST)
        kind = message_class(topics.CORRECTION.type_name)
        node.create_subscription(kind, topics.CORRECTION.name, self._take_correction, profile)

    @property
    def is_behind(self) -> bool:
        """Whether the replay has to wait for the front end, if there is one."""
        name = topics.CORRECTION.name
        return self._backlog.is_too_long and self._node.count_publishers(name) > 0

    def _take_scan(self, message: Any) -> None:
        with suppress(Refusal):
            self._backlog.scanned(link_decoding.scan_beams(message))

    def _take_correction(self, message: Any) -> None:
        with suppress(Refusal):
            self._backlog.corrected(link_decoding.correction(message).stamp_ns)
            self._note()
