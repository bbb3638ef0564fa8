# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What keeps a fast replay lossless: it waits for those who listen, but not for ever."""

import time
from collections.abc import Callable, Sequence

from rclpy.node import Node

from msss_graphslam.nodes.names import DRIVER
from msss_graphslam.nodes.replay.audience import Audience
from msss_graphslam.nodes.replay.follower import Follower
from msss_graphslam.nodes.replay.followers import Followers
from msss_graphslam.nodes.replay.output import Output
from msss_graphslam.nodes.trigger import Spin

__all__ = ["Flow"]

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
        self._followers = Followers(node, self._note_news)
        self.sent = self._followers.sent
        self.restart = self._followers.restart

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
        for name, follower in self._followers.told.items():
            self._await_end(follower, name)
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
        if self._followers.is_one_behind:
            return False
        if self._followers.is_reckoning_heard:
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
        self._followers.give_up_those_behind()
        self._release()
        self._is_impatient = True

    def _release(self) -> None:
        """Send on, whatever those who listen have told so far."""
        self._members = self._audience.members()
        self._followers.release()

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
