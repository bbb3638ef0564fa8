# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What keeps a fast replay lossless: it waits for those who listen, but not for ever."""

import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from typing import Any

from rclpy.node import Node
from rclpy.qos import DurabilityPolicy

from msss_graphslam.messages import link_decoding, topics
from msss_graphslam.messages.refusal import Refusal
from msss_graphslam.nodes.conclusion import Spin
from msss_graphslam.nodes.replay.audience import Audience
from msss_graphslam.nodes.replay.backlog import Backlog
from msss_graphslam.nodes.replay.lead import Lead, header_stamp_ns
from msss_graphslam.nodes.replay.output import Output
from msss_graphslam.recordings.mcap_reading import RawMessage
from msss_graphslam.ros.messages import message_class
from msss_graphslam.ros.qos import profile_of

__all__ = ["Flow"]

_SENSORS = (topics.SONAR_PING, topics.IMU, topics.PRESSURE, topics.DVL)
_STALL = 5.0
_TELL_EVERY = 5.0
_LOOK_EVERY = 0.5
_ACKNOWLEDGEMENT = 0.02
_QUIET = 0.3
_NEWEST = 10


class Flow:
    """Holds a replay back until its listeners have what was sent.

    Parameters
    ----------
    node
        The replay's node.
    output
        Its publishers.
    names
        Nodes to wait for.
    patience
        How long [s] to wait for one that stops listening.
    spin
        Spins the node for at most so many seconds.
    """

    def __init__(
        self, node: Node, output: Output, names: Sequence[str], patience: float, spin: Spin
    ) -> None:
        self.stalls = 0
        self.given_up: set[str] = set()
        self._output = output
        self._audience = Audience(node, names, output.by_name)
        self._patience = patience
        self._spin = spin
        self._log = node.get_logger()
        self._lead = Lead()
        self._backlog = Backlog()
        self._news = 0
        self._looked = 0.0
        self._members: frozenset[bytes] = frozenset()
        self._is_impatient = False
        self._listen(node)

    def restart(self) -> None:
        """Forget what was sent: the next message is the first."""
        self._lead.restart()
        self._backlog.restart()

    def sent(self, raw: RawMessage) -> None:
        """Note what was just published."""
        if topics.find(raw.channel.topic) in _SENSORS:
            self._lead.sent(raw.log_ns, raw.data)

    def gather(self, patience: float | None = None) -> None:
        """Wait until all nodes listen; with ``patience`` [s] go on without those that do not."""
        began = told = time.monotonic()
        while missing := self._audience.missing(self.given_up):
            now = time.monotonic()
            if patience is not None and now - began > patience:
                self._give_up(missing)
                return
            if now - told >= _TELL_EVERY:
                told = now
                self._log.info(f"waiting for {_listed(missing)}")
            self._spin(0.02)
        self._members = self._audience.members()

    def hold(self) -> None:
        """Wait until more may be sent."""
        now = time.monotonic()
        if now - self._looked >= _LOOK_EVERY:
            self._looked = now
            self.given_up -= self.given_up - set(self._audience.missing())
            self.gather(self._patience)
        if not self._wait(self._is_free):
            self._sit_out()

    def drain(self) -> None:
        """Wait until everything has arrived and dead reckoning has worked it off."""
        if not self._wait(lambda: self._output.all_acknowledged(_ACKNOWLEDGEMENT)):
            self._log.warning("not everything that was sent has been acknowledged")
        if self._has_settled() and not self._wait(lambda: self._lead.is_over):
            self._log.warning("dead reckoning has not reached the end of the bag")
        news = -1
        while news != self._news:
            news = self._news
            self._spin_for(_QUIET)

    def _listen(self, node: Node) -> None:
        kind = message_class(topics.SETTLED_ODOMETRY.type_name)
        profile = profile_of(topics.SETTLED_ODOMETRY, _NEWEST)
        profile.durability = DurabilityPolicy.VOLATILE
        node.create_subscription(kind, topics.SETTLED_ODOMETRY.name, self._take, profile, raw=True)
        self._node = node
        self._follow_graph(node)

    def _follow_graph(self, node: Node) -> None:
        """Hear of scans from now on; of corrections the newest, which may be out already."""
        for topic, take in (
            (topics.SCAN_BEAMS, self._take_scan),
            (topics.CORRECTION, self._take_correction),
        ):
            kind, profile = message_class(topic.type_name), profile_of(topic, _NEWEST)
            if topic is topics.SCAN_BEAMS:
                profile.durability = DurabilityPolicy.VOLATILE
            node.create_subscription(kind, topic.name, take, profile)

    def _take_scan(self, message: Any) -> None:
        with suppress(Refusal):
            self._backlog.scanned(link_decoding.scan_beams(message))

    def _take_correction(self, message: Any) -> None:
        with suppress(Refusal):
            self._backlog.corrected(link_decoding.correction(message).stamp_ns)
            self._news += 1

    def _is_graph_behind(self) -> bool:
        listens = self._node.count_publishers(topics.CORRECTION.name) > 0
        return self._backlog.is_too_long and bool(listens)

    def _has_settled(self) -> bool:
        return bool(self._node.count_publishers(topics.SETTLED_ODOMETRY.name) > 0)

    def _take(self, data: Any) -> None:
        stamp_ns = header_stamp_ns(data)
        if stamp_ns is not None and self._lead.settled(stamp_ns):
            self._news += 1
            self._is_impatient = False

    def _is_free(self) -> bool:
        if self._has_settled() and not self._is_impatient:
            return not (self._lead.is_too_long or self._is_graph_behind())
        return not self._output.is_full or self._is_acknowledged()

    def _is_acknowledged(self) -> bool:
        """Whether all has arrived; a listener that was given up is not waited for again.

        Listeners acknowledge every 3 s only (the middleware's heartbeat): asked for a window of
        messages, not for each batch.
        """
        done = self._output.all_acknowledged(_ACKNOWLEDGEMENT)
        self._is_impatient = self._is_impatient and not done
        return done or self._is_impatient

    def _wait(self, condition: Callable[[], bool]) -> bool:
        """Wait for the condition; return False after a time without any progress."""
        since, news = time.monotonic(), self._news
        while not condition():
            self._spin(0.01)
            if news != self._news:
                since, news = time.monotonic(), self._news
            if time.monotonic() - since > _STALL:
                return False
        return True

    def _sit_out(self) -> None:
        """Wait for progress, or for a node that was started again, but not for ever."""
        self.stalls += 1
        self._log.warning(
            f"no progress for {_STALL:.0f} s: waiting at most {self._patience:.0f} s for"
            " a node to go on, or to be started again"
        )
        until = time.monotonic() + self._patience
        while not self._is_free() and time.monotonic() < until and not self._is_renewed():
            self._spin(0.05)
        self._members = self._audience.members()
        self._lead.release()
        self._backlog.restart()
        self._is_impatient = True

    def _is_renewed(self) -> bool:
        """Whether other subscriptions than at the last progress listen."""
        if self._audience.missing(self.given_up):
            return False
        return self._audience.members() != self._members

    def _give_up(self, missing: dict[str, str]) -> None:
        self.given_up |= set(missing)
        self._log.warning(f"going on without {_listed(missing)}")

    def _spin_for(self, seconds: float) -> None:
        until = time.monotonic() + seconds
        while (left := until - time.monotonic()) > 0.0:
            self._spin(left)


def _listed(missing: dict[str, str]) -> str:
    return ", ".join(f"{name} ({lacking})" for name, lacking in missing.items())
