# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What keeps a fast replay lossless: it waits for those who listen, but not for ever."""

import time
from collections.abc import Callable, Sequence

from rclpy.node import Node

from msss_graphslam.messages import topics
from msss_graphslam.nodes.names import DRIVER
from msss_graphslam.nodes.replay.audience import Audience
from msss_graphslam.nodes.replay.follower import Follower, GraphFollower
from msss_graphslam.nodes.replay.output import Output
from msss_graphslam.nodes.replay.receipt import receipt_ns
from msss_graphslam.nodes.trigger import Spin
from msss_graphslam.recordings.mcap_reading import RawMessage

__all__ = ["Flow"]

_SENSORS = (topics.SONAR_PING, topics.IMU, topics.PRESSURE, topics.DVL)
# With the batch that is sent before the next look less than half a second, after which dead
# reckoning would take beams that came first for a sign that the IMU has gone.
_RECKONING_LIMIT_NS = 300_000_000
# Much less than the beams that dead reckoning keeps for a scan generation that is started again.
_SCANNING_LIMIT_NS = 5_000_000_000
# Beams that come late must not look like a sonar that is silent: much less than its patience.
_DRIVING_LIMIT_NS = 1_000_000_000
_STALL = 5.0
_TELL_EVERY = 5.0
_DRIVER_WANTED = (
    "; the bag has the head's bytes alone, which want a micron_driver with source:=topic"
    " (replay.launch.py sonar:=raw)"
)
_LOOK_EVERY = 0.5
_ACKNOWLEDGEMENT = 0.02
_QUIET = 0.3


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
        self._news = 0
        self._looked = 0.0
        self._members: frozenset[bytes] = frozenset()
        self._is_impatient = False
        note = self._note_news
        self._reckoning = Follower(node, topics.SETTLED_ODOMETRY, _RECKONING_LIMIT_NS, note)
        self._scanning = Follower(node, topics.SCAN_PROGRESS, _SCANNING_LIMIT_NS, note)
        self._driving = Follower(node, topics.RAW_TAKEN, _DRIVING_LIMIT_NS, note)
        self._graph = GraphFollower(node, note)

    def restart(self) -> None:
        """Forget what was sent: the next message is the first."""
        self._driving.restart()
        self._reckoning.restart()
        self._scanning.restart()
        self._graph.restart()

    def sent(self, raw: RawMessage) -> None:
        """Note what was just published."""
        topic = topics.find(raw.channel.topic)
        if topic in _SENSORS:
            self._reckoning.sent(raw)
        if topic is topics.SONAR_RAW:
            self._driving.sent_at(raw.log_ns, receipt_ns(raw))
        if topic is topics.SONAR_PING:
            self._scanning.sent(raw)

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
                hint = _DRIVER_WANTED if DRIVER in missing else ""
                self._log.info(f"waiting for {_listed(missing)}{hint}")
            self._spin(0.02)
        self._members = self._audience.members()

    def hold(self) -> None:
        """Wait until more may be sent."""
        now = time.monotonic()
        if now - self._looked >= _LOOK_EVERY:
            self._looked = now
            self.given_up -= self.given_up - set(self._audience.missing())
            self.gather(self._patience)
        self._wait(self._is_free)

    def drain(self) -> None:
        """Wait until everything has arrived and those that tell have worked it off."""
        if not self._goes_on_until(lambda: self._output.all_acknowledged(_ACKNOWLEDGEMENT)):
            self._log.warning("not everything that was sent has been acknowledged")
        self._await_end(self._driving, "the driver")
        self._await_end(self._reckoning, "dead reckoning")
        self._await_end(self._scanning, "scan generation")
        news = -1
        while news != self._news:
            news = self._news
            self._spin_for(_QUIET)

    def _await_end(self, follower: Follower, name: str) -> None:
        self._wait(lambda: follower.is_through or not follower.is_heard)
        if not follower.is_through:
            self._log.warning(f"{name} has not reached the end of the bag")

    def _note_news(self) -> None:
        self._news += 1
        self._is_impatient = False

    def _is_free(self) -> bool:
        followed = (self._driving, self._reckoning, self._scanning, self._graph)
        if any(follower.is_behind for follower in followed):
            return False
        if self._reckoning.is_heard:
            return True
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
        """Wait for the condition, also through the restart of a node; return whether it holds."""
        if self._goes_on_until(condition):
            return True
        if not self._is_renewed():
            self._sit_out(condition)
        if self._is_renewed():
            self._log.info("a node was started again")
            self._release()
            return self._goes_on_until(condition)
        return condition()

    def _goes_on_until(self, condition: Callable[[], bool]) -> bool:
        """Wait while there is progress; a node that was started again ends the wait, too."""
        since, news = time.monotonic(), self._news
        looked = since
        while not condition():
            self._spin(0.01)
            now = time.monotonic()
            if news != self._news:
                since, news = now, self._news
            if now - since > _STALL:
                return False
            if now - looked > _LOOK_EVERY:
                looked = now
                if self._is_renewed():
                    return False
        return True

    def _sit_out(self, condition: Callable[[], bool]) -> None:
        """Wait for progress, or for a node that was started again, but not for ever."""
        self.stalls += 1
        self._log.warning(
            f"no progress for {_STALL:.0f} s: waiting at most {self._patience:.0f} s for"
            " a node to go on, or to be started again"
        )
        until = time.monotonic() + self._patience
        while not condition() and not self._is_renewed():
            self._spin(0.05)
            if time.monotonic() > until:
                self._give_up_those_behind()
                return

    def _give_up_those_behind(self) -> None:
        for follower in (self._driving, self._reckoning, self._scanning):
            if not follower.is_through:
                follower.give_up()
        self._graph.restart()
        self._release()
        self._is_impatient = True

    def _release(self) -> None:
        """Send on, whatever those who listen have told so far."""
        self._members = self._audience.members()
        self._driving.release()
        self._reckoning.release()
        self._scanning.release()

    def _is_renewed(self) -> bool:
        """Whether subscriptions listen that did not at the last progress."""
        if self._audience.missing(self.given_up):
            return False
        return bool(self._audience.members() - self._members)

    def _give_up(self, missing: dict[str, str]) -> None:
        self.given_up |= set(missing)
        self._log.warning(f"going on without {_listed(missing)}")

    def _spin_for(self, seconds: float) -> None:
        until = time.monotonic() + seconds
        while (left := until - time.monotonic()) > 0.0:
            self._spin(left)


def _listed(missing: dict[str, str]) -> str:
    return ", ".join(f"{name} ({lacking})" for name, lacking in missing.items())
