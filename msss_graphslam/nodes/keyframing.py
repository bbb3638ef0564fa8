# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The front end between its links: scans in a queue, one keyframe at a time."""

from collections import Counter, deque
from collections.abc import Callable
from time import monotonic

import numpy as np

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.graph.front_end import FrontEnd
from msss_graphslam.core.recipes import Recipe
from msss_graphslam.core.types import GraphPoses, KeyframeReport, MapCorrection, Scan, Stamps
from msss_graphslam.messages.refusal import Refusal
from msss_graphslam.nodes.known_keyframes import first_of, same_beginning
from msss_graphslam.nodes.waiting_part import WaitingPart

__all__ = ["Keyframing"]

_REMEMBERED = 20


class Keyframing:
    """Takes the next scan only when the back end has answered for the last one.

    So the result does not depend on how fast scans come. ``send`` is given what goes to the back
    end, ``place`` what goes to dead reckoning. What goes wrong is counted in ``refused``.
    ``seconds`` are what the latest scans took.
    """

    def __init__(
        self,
        configuration: Configuration,
        recipe: Recipe,
        refused: Counter[str],
        send: Callable[[KeyframeReport], object],
        place: Callable[[MapCorrection], object],
        clock: Callable[[], float] = monotonic,
    ) -> None:
        self._front_end = FrontEnd(configuration, recipe)
        self._refused = refused
        self._send = send
        self._place = place
        self._clock = clock
        self._queue: deque[Scan] = deque()
        self._stamps: set[int] = set()
        self._newest_ns = -(2**62)
        self._part = WaitingPart()
        self._known: GraphPoses | None = None
        self._behind: GraphPoses | None = None
        self._pending: Scan | None = None
        self._is_second_try = False
        self._asked_at = 0.0
        self.seconds: deque[float] = deque(maxlen=_REMEMBERED)

    @property
    def keyframes(self) -> int:
        """How many keyframes there are."""
        return len(self._front_end.nodes)

    @property
    def waiting(self) -> int:
        """How many scans are not yet worked off, the one without an answer among them."""
        return len(self._queue) + (self._pending is not None)

    @property
    def waited(self) -> float:
        """For how long the back end has owed an answer [s]."""
        return self._clock() - self._asked_at if self._pending is not None else 0.0

    def configure(self, configuration: Configuration) -> None:
        """Search loop closures by other parameters from the next scan on."""
        self._front_end.configure(configuration)

    def add_scan(self, scan: Scan) -> None:
        """Queue a scan; one that is no keyframe or was here before is left out."""
        if not scan.usable or scan.stamp_ns in self._stamps:
            return
        if scan.stamp_ns < self._newest_ns:
            raise Refusal("scan_beams_out_of_order")
        self._stamps.add(scan.stamp_ns)
        self._newest_ns = scan.stamp_ns
        self._part.follow(scan)
        self._queue.append(scan)
        self._advance()

    def add_part(self, part: Scan) -> None:
        """Correct the pose by the turn in progress, once all before it is worked off."""
        self._part.add(part)
        self._preview()

    def add_answer(self, known: GraphPoses) -> None:
        """Take the back end's answer, if it is one to the newest keyframe."""
        self._known = known
        if self._pending is None:
            return
        if self._fits(known):
            self._settle(known)
        elif same_beginning(self._own_stamps, known.stamps_ns):
            self._behind = known
        else:
            self._refused["graph_of_another_front_end"] += 1
            self._follow(known, self._pending)
        self._advance()

    def give_up(self) -> None:
        """Go on without the back end's answer."""
        if self._pending is None:
            return
        self._refused["back_end_silent"] += 1
        if self._behind is not None:
            self._withdraw(self._behind)
        else:
            self._settle_alone()
        self._advance()

    @property
    def _own_stamps(self) -> Stamps:
        stamps = [node.first_scan.stamp_ns for node in self._front_end.nodes]
        return np.array(stamps, dtype=np.int64)

    def _fits(self, known: GraphPoses) -> bool:
        own = self._own_stamps
        return len(known.stamps_ns) >= len(own) and same_beginning(own, known.stamps_ns)

    def _advance(self) -> None:
        while self._queue and self._pending is None:
            scan = self._queue.popleft()
            if not self._front_end.nodes:
                self._begin(scan)
            self._try(scan)
            if self._pending is scan and self._known is not None and self._fits(self._known):
                self._settle(self._known)
        self._preview()

    def _preview(self) -> None:
        part = self._part.take() if self._pending is None else None
        correction = self._front_end.preview(part) if part is not None else None
        if correction is not None:
            self._place(correction)

    def _begin(self, scan: Scan) -> None:
        """Go on where an earlier front end has ended, if there was one."""
        if self._known is None or not len(self._known.stamps_ns):
            return
        stamps = self._known.stamps_ns
        if scan.stamp_ns in stamps or scan.stamp_ns > stamps[-1]:
            self._adopt(self._known, scan)

    def _adopt(self, known: GraphPoses, scan: Scan) -> int:
        """Adopt the keyframes before the scan; return how many these are."""
        count = int(np.searchsorted(known.stamps_ns, scan.stamp_ns))
        if count:
            self._front_end.adopt(first_of(known, count))
        return count

    def _try(self, scan: Scan) -> None:
        nodes, poses = list(self._front_end.nodes), self._front_end.poses.copy()
        begun = self._clock()
        try:
            report = self._front_end.report(self._front_end.add_scan(scan))
        except Exception:
            self._front_end.nodes, self._front_end.poses = nodes, poses
            self._pending = None
            raise
        self._asked_at = self._clock()
        self.seconds.append(self._asked_at - begun)
        self._pending, self._behind = scan, None
        self._send(report)

    def _follow(self, known: GraphPoses, scan: Scan) -> None:
        """Send the scan once more, as what it is in the graph that the back end has."""
        if self._is_second_try or not self._adopt(known, scan):
            self._settle_alone()
            return
        self._is_second_try = True
        self._try(scan)

    def _settle(self, known: GraphPoses) -> None:
        count = self.keyframes
        self._front_end.correct(known.poses[:count], known.covariances[count - 1])
        self._finish()

    def _settle_alone(self) -> None:
        front_end = self._front_end
        front_end.correct(front_end.poses, front_end.nodes[-1].covariance)
        self._finish()

    def _finish(self) -> None:
        self._pending, self._is_second_try = None, False
        self._place(self._front_end.correction())

    def _withdraw(self, known: GraphPoses) -> None:
        """Forget the keyframes that the back end has not taken."""
        self._refused["keyframe_not_taken"] += 1
        del self._front_end.nodes[len(known.stamps_ns) :]
        self._front_end.poses = known.poses
        self._pending, self._is_second_try = None, False
