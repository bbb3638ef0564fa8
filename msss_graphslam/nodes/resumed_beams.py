# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Beams from where an earlier process has ended: kept ones first, then those of the sonar."""

from collections.abc import Callable
from time import monotonic

from msss_graphslam.core.types import Beam

__all__ = ["ResumedBeams"]

_EVER = -(2**62)
# Longest waits [s]: for others to be found, for where to begin, for a kept beam to come.
_DISCOVERY = 3.0
_BEGINNING = 10.0
_JOIN = 10.0


class ResumedBeams:
    """Hands on every beam once, in the order of the stamps; no ROS.

    The beams that dead reckoning has kept are followed until they reach the first one that the
    sonar has sent since the start: so none is missing in between.

    Parameters
    ----------
    take
        Gets the beams that are in no scan yet.
    learn
        Gets the kept beams before those.
    is_kept, is_told
        Whether somebody keeps beams, and whether somebody tells what was taken.
    """

    def __init__(
        self,
        take: Callable[[Beam], None],
        learn: Callable[[Beam], None],
        is_kept: Callable[[], bool],
        is_told: Callable[[], bool],
        clock: Callable[[], float] = monotonic,
    ) -> None:
        self._take = take
        self._learn = learn
        self._is_kept = is_kept
        self._is_told = is_told
        self._clock = clock
        self._started = clock()
        self._heard_at: float | None = None
        self._from_ns: int | None = None
        self._newest_ns = _EVER
        self._kept: list[Beam] = []
        self._own: list[Beam] = []
        self.joined = False

    @property
    def expects_more(self) -> bool:
        """Whether kept beams may still be on their way."""
        return not self.joined and self._clock() - self._started <= 2.0 * _DISCOVERY

    def hear(self, beam: Beam) -> None:
        """Note a beam of the sonar."""
        if self.joined:
            self._hand_on(beam, self._take)
            return
        self._heard_at = self._clock() if self._heard_at is None else self._heard_at
        self._own.append(beam)
        self.look()

    def recall(self, beam: Beam) -> None:
        """Note a kept beam."""
        if not self.joined:
            self._kept.append(beam)
            self.look()

    def begin_at(self, stamp_ns: int) -> None:
        """Note where the scans that others have taken end."""
        if self._from_ns is None:
            self._from_ns = stamp_ns
            self.look()

    def look(self) -> None:
        """Hand on what can be; to be called now and then."""
        if not self.joined and self._may_begin():
            self._hand_on_kept()
            if self._is_whole():
                self.join()

    def join(self) -> None:
        """Hand on all that there is, and from now on the sonar's beams alone."""
        self.joined = True
        self._hand_on_kept()
        own, self._own = self._own, []
        for beam in own:
            self._hand_on(beam, self._take)

    def _hand_on_kept(self) -> None:
        begin_ns = _EVER if self._from_ns is None else self._from_ns
        kept, self._kept = self._kept, []
        for beam in kept:
            self._hand_on(beam, self._learn if beam.stamp_ns < begin_ns else self._take)

    def _hand_on(self, beam: Beam, to: Callable[[Beam], None]) -> None:
        if beam.stamp_ns > self._newest_ns:
            self._newest_ns = beam.stamp_ns
            to(beam)

    def _may_begin(self) -> bool:
        if self._from_ns is not None:
            return True
        lasting = self._clock() - self._started
        return lasting > _BEGINNING or (lasting > _DISCOVERY and not self._is_told())

    def _is_whole(self) -> bool:
        """Whether the kept beams reach those of the sonar, or never will."""
        if self._heard_at is None:
            return False
        if self._newest_ns >= self._own[0].stamp_ns:
            return True
        now = self._clock()
        if now - self._heard_at > _JOIN:
            return True
        return now - self._started > _DISCOVERY and not self._is_kept()
