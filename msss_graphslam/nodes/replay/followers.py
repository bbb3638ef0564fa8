# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""All those that tell a replay how far they are: who is told of what, and how far each may lag."""

from collections.abc import Callable

from rclpy.node import Node

from msss_graphslam.messages import topics
from msss_graphslam.nodes.replay.follower import Follower, GraphFollower
from msss_graphslam.nodes.replay.receipt import receipt_ns
from msss_graphslam.recordings.mcap_reading import RawMessage

__all__ = ["Followers"]

_SENSORS = (topics.SONAR_PING, topics.IMU, topics.PRESSURE, topics.DVL)
# With the batch that is sent before the next look less than half a second, after which dead
# reckoning would take beams that came first for a sign that the IMU has gone.
_RECKONING_LIMIT_NS = 300_000_000
# Much less than the beams that dead reckoning keeps for a scan generation that is started again.
_SCANNING_LIMIT_NS = 5_000_000_000
# Beams that come late must not look like a sonar that is silent: much less than its patience.
_DRIVING_LIMIT_NS = 1_000_000_000


class Followers:
    """The driver, dead reckoning, scan generation and the front end; ``note`` as of ``Follower``.

    ``told`` are the first three by name, in the order in which they have all that was sent.
    """

    def __init__(self, node: Node, note: Callable[[], object]) -> None:
        self._reckoning = Follower(node, topics.SETTLED_ODOMETRY, _RECKONING_LIMIT_NS, note)
        self._scanning = Follower(node, topics.SCAN_PROGRESS, _SCANNING_LIMIT_NS, note)
        self._driving = Follower(node, topics.RAW_TAKEN, _DRIVING_LIMIT_NS, note)
        self._graph = GraphFollower(node, note)
        self.told = {
            "the driver": self._driving,
            "dead reckoning": self._reckoning,
            "scan generation": self._scanning,
        }

    @property
    def is_one_behind(self) -> bool:
        """Whether the replay has to wait for one of them."""
        return self._graph.is_behind or any(each.is_behind for each in self.told.values())

    @property
    def is_reckoning_heard(self) -> bool:
        """Whether dead reckoning is there and has not been given up."""
        return self._reckoning.is_heard

    def sent(self, raw: RawMessage) -> None:
        """Note what was just published."""
        topic = topics.find(raw.channel.topic)
        if topic in _SENSORS:
            self._reckoning.sent(raw)
        if topic is topics.SONAR_RAW:
            self._driving.sent_at(raw.log_ns, receipt_ns(raw))
        if topic is topics.SONAR_PING:
            self._scanning.sent(raw)

    def restart(self) -> None:
        """Forget what was sent: the next message is the first."""
        for follower in self.told.values():
            follower.restart()
        self._graph.restart()

    def release(self) -> None:
        """Allow each its limit once more from here, whatever it says."""
        for follower in self.told.values():
            follower.release()

    def give_up_those_behind(self) -> None:
        """Wait no more for those that have not taken all, until they tell something new."""
        for follower in self.told.values():
            if not follower.is_through:
                follower.give_up()
        self._graph.restart()
