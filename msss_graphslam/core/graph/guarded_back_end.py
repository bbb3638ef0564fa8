# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The back end behind a guard: loop closures that contradict what is known stay outside."""

from collections.abc import Sequence
from dataclasses import replace

from msss_graphslam.config.groups import BackEnd as BackEndConfig
from msss_graphslam.core.graph.back_end import BackEnd
from msss_graphslam.core.graph.closure_gate import CONTRADICTS, STRETCH, ClosureGate
from msss_graphslam.core.graph.closure_review import ClosureReview
from msss_graphslam.core.graph.known_places import KNOWN_BETTER, hung_again
from msss_graphslam.core.types import Array, Constraint, ConstraintKind

__all__ = ["CONTRADICTS", "WITHDRAWN", "GuardedBackEnd"]

WITHDRAWN = "withdrawn"
"""Refusal of a closure that the graph has come to contradict; the graph may take it back."""


class GuardedBackEnd:
    """Keyframes and tried constraints in, optimised poses and covariances out.

    ``tried`` are all constraints in the order of trial, refused as they stand now. ``withdrawals``
    and ``readmissions`` count what has been taken out again and put back. Without ``guards`` the
    graph takes and keeps whatever was accepted.
    """

    def __init__(self, config: BackEndConfig, *, guards: bool) -> None:
        """Begin empty; ``guards`` also has the matches of a scan share their weight."""
        self._bound = config.contradiction if guards else 0.0
        self._back_end = BackEnd(config, divides=guards)
        self._gate = ClosureGate(self._bound)
        self._review = ClosureReview(self._bound)
        self._watched: list[int] = []
        self._begins: list[int] = []
        self.tried: list[Constraint] = []
        self.withdrawals = self.readmissions = 0

    def take(self, pose: Array, tried: Sequence[Constraint]) -> tuple[Array, Array]:
        """Take in a keyframe; return all poses (n, 3) and the newest one's covariance (3, 3).

        As ``BackEnd.take``, which raises ValueError for what no graph can take; nothing has
        changed then.
        """
        if not self._bound:
            answer = self._back_end.take(pose, tried)
            self.tried += tried
            return answer
        before = len(self._gate)
        try:
            judged = self._gate.pass_through(tried) if tried else []
            if any(edge.refusal == CONTRADICTS for edge in judged):
                judged = hung_again(judged)
            released = self._to_be_released()
            poses, covariance = self._back_end.take(pose, judged, released)
        except Exception:
            self._cut(before)
            raise
        self._cut(len(poses))
        self._note(judged)
        return self._reviewed(poses, covariance)

    def _to_be_released(self) -> list[Constraint]:
        """Return by what a scan of a known place hangs, once nothing else will hang on it."""
        number = len(self._begins) - STRETCH
        if number < 1:
            return []
        begin, end = self._begins[number : number + 2]
        edges = self.tried[begin:end]
        holds = [edge for edge in edges if edge.accepted]
        is_leaf = all(edge.first != number for edge in self.tried[end:] if edge.accepted)
        was_known = any(edge.refusal == KNOWN_BETTER for edge in edges)
        return holds if holds and was_known and is_leaf else []

    def _cut(self, count: int) -> None:
        if len(self._gate) > count:
            self._gate.drop_newest()

    def _note(self, judged: Sequence[Constraint]) -> None:
        """Keep the constraints, and watch the closures among those that the graph has taken."""
        closures = [
            number
            for number, edge in enumerate(judged, len(self.tried))
            if edge.kind is ConstraintKind.LOOP and edge.accepted
        ]
        self._begins.append(len(self.tried))
        self.tried += judged
        self._watched += closures
        self._review.add([self.tried[number] for number in closures], self._gate.slack)

    def _reviewed(self, poses: Array, covariance: Array) -> tuple[Array, Array]:
        verdict = self._review.judge(poses)
        if not verdict.withdrawn and not verdict.readmitted:
            return poses, covariance
        out = [self.tried[self._watched[number]] for number in verdict.withdrawn]
        for number in verdict.withdrawn:
            self._set_refusal(number, WITHDRAWN)
        held = self._held_by_chain({edge.second for edge in out})
        for number in verdict.readmitted:
            self._set_refusal(number, "")
        back = [self.tried[self._watched[number]] for number in verdict.readmitted]
        self.withdrawals += len(out)
        self.readmissions += len(back)
        poses = self._back_end.exchange(out, back + held)
        return poses, self._back_end.covariance(len(poses) - 1)

    def _held_by_chain(self, keyframes: set[int]) -> list[Constraint]:
        """Return the edges by which keyframes hang on their predecessors, if they were left out.

        A keyframe of a known place may hang on its closures alone.
        """
        places = [
            place
            for place, edge in enumerate(self.tried)
            if edge.second in keyframes and edge.refusal == KNOWN_BETTER
        ]
        for place in places:
            self.tried[place] = replace(self.tried[place], refusal="")
        return [self.tried[place] for place in places]

    def _set_refusal(self, number: int, refusal: str) -> None:
        place = self._watched[number]
        self.tried[place] = replace(self.tried[place], refusal=refusal)
