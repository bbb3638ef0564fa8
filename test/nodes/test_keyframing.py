# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What the front end does when the back end is late, new, silent, or of another opinion."""

from collections import Counter
from functools import cache
from typing import Any

import numpy as np
import pytest
from nodes.linked_nodes import LinkedNodes, parts_of, scans_of
from small_mission import recorded

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.graph.front_end import FrontEnd
from msss_graphslam.core.recipes import ESTIMATORS
from msss_graphslam.core.types import GraphPoses, KeyframeReport, MapCorrection, Scan
from msss_graphslam.messages.refusal import Refusal
from msss_graphslam.nodes.keyframing import Keyframing


@cache
def scans() -> tuple[Scan, ...]:
    return tuple(scan for scan in scans_of(recorded().measurements) if scan.usable)[:6]


class Lonely:
    """A front end whose back end the test plays."""

    def __init__(self, estimator: str = "uspic") -> None:
        self.refused: Counter[str] = Counter()
        self.reports: list[KeyframeReport] = []
        self.corrections: list[MapCorrection] = []
        self.now = 0.0
        self.front = Keyframing(
            Configuration(),
            ESTIMATORS[estimator],
            self.refused,
            self.reports.append,
            self.corrections.append,
            lambda: self.now,
        )


def answer(reports: list[KeyframeReport], **changes: Any) -> GraphPoses:
    fields = {
        "stamps_ns": np.array([report.stamp_ns for report in reports], dtype=np.int64),
        "poses": np.array([report.pose for report in reports]).reshape(-1, 3),
        "odometry": np.array([report.odometry for report in reports]).reshape(-1, 3),
        "covariances": np.tile(1e-4 * np.eye(3), (len(reports), 1, 1)),
    }
    return GraphPoses(**{**fields, **changes})


def test_the_next_scan_waits_for_the_answer() -> None:
    lonely = Lonely()
    for scan in scans()[:3]:
        lonely.front.add_scan(scan)
    assert [report.number for report in lonely.reports] == [0]
    assert lonely.front.waiting == 3
    lonely.front.add_answer(answer(lonely.reports))
    assert [report.number for report in lonely.reports] == [0, 1]
    assert lonely.front.waiting == 2
    assert len(lonely.corrections) == 1


def test_the_answer_of_the_keyframe_before_is_not_taken_for_it() -> None:
    lonely = Lonely()
    for scan in scans()[:2]:
        lonely.front.add_scan(scan)
    early = answer(lonely.reports)
    lonely.front.add_answer(early)
    lonely.front.add_answer(early)
    assert lonely.front.waiting == 1
    assert len(lonely.corrections) == 1
    assert not lonely.refused


def test_the_next_keyframe_starts_from_the_poses_of_the_answer() -> None:
    lonely = Lonely()
    for scan in scans()[:2]:
        lonely.front.add_scan(scan)
    lonely.front.add_answer(answer(lonely.reports))
    moved = answer(lonely.reports)
    moved.poses[-1] += [5.0, -3.0, 0.0]
    lonely.front.add_answer(moved)
    assert lonely.corrections[-1].pose[0] - lonely.corrections[0].pose[0] > 3.0
    lonely.front.add_scan(scans()[2])
    assert np.linalg.norm(lonely.reports[-1].pose[:2] - moved.poses[-1, :2]) < 3.0


def test_a_scan_that_comes_twice_is_taken_once() -> None:
    linked = LinkedNodes()
    for scan in (scans()[0], scans()[0], scans()[1], scans()[0]):
        linked.add_scan(scan)
    assert linked.front.keyframes == 2
    assert not linked.refused


def test_a_scan_older_than_the_last_is_refused() -> None:
    lonely = Lonely()
    lonely.front.add_scan(scans()[1])
    with pytest.raises(Refusal, match="scan_beams_out_of_order"):
        lonely.front.add_scan(scans()[0])


def test_time_passes_while_an_answer_is_owed_alone() -> None:
    lonely = Lonely()
    assert lonely.front.waited == 0.0
    lonely.front.add_scan(scans()[0])
    lonely.now = 7.0
    assert lonely.front.waited == 7.0
    lonely.front.add_answer(answer(lonely.reports))
    assert lonely.front.waited == 0.0


def test_a_silent_back_end_is_counted_and_gone_without() -> None:
    lonely = Lonely()
    for scan in scans()[:2]:
        lonely.front.add_scan(scan)
    lonely.front.give_up()
    lonely.front.give_up()
    assert lonely.refused == {"back_end_silent": 2}
    assert [report.number for report in lonely.reports] == [0, 1]
    assert len(lonely.corrections) == 2
    lonely.front.give_up()
    assert lonely.refused.total() == 2


def test_the_back_end_takes_up_what_came_while_it_was_away() -> None:
    linked = LinkedNodes(answers=False)
    for scan in scans()[:3]:
        linked.add_scan(scan)
        linked.front.give_up()
    linked.answers = True
    linked.add_scan(scans()[3])
    linked.deliver()
    assert len(linked.back.poses) == linked.front.keyframes == 4
    assert linked.front.waiting == 0


def test_a_keyframe_that_the_back_end_does_not_take_is_withdrawn() -> None:
    lonely = Lonely()
    lonely.front.add_scan(scans()[0])
    known = answer(lonely.reports)
    lonely.front.add_answer(known)
    lonely.front.add_scan(scans()[1])
    lonely.front.add_answer(known)
    lonely.front.give_up()
    assert lonely.refused == {"back_end_silent": 1, "keyframe_not_taken": 1}
    lonely.front.add_scan(scans()[2])
    assert [report.number for report in lonely.reports] == [0, 1, 1]


def test_a_front_end_that_starts_anew_catches_up() -> None:
    linked = LinkedNodes()
    for scan in scans()[:4]:
        linked.add_scan(scan)
    before = linked.back.poses.copy()
    linked.start_front_end()
    linked.replay_scans()
    assert linked.front.keyframes == 4
    np.testing.assert_array_equal(linked.back.poses, before)
    linked.add_scan(scans()[4])
    assert len(linked.back.poses) == 5
    assert not linked.refused


@pytest.mark.parametrize("known_before", [True, False])
def test_a_front_end_without_the_old_scans_goes_on_with_the_graph(known_before: bool) -> None:
    linked = LinkedNodes()
    for scan in scans()[:3]:
        linked.add_scan(scan)
    linked.start_front_end()
    if known_before:
        linked.front.add_answer(linked.answer())
    for scan in scans()[3:]:
        linked.add_scan(scan)
    assert len(linked.back.poses) == linked.front.keyframes == len(scans())
    assert linked.refused["graph_of_another_front_end"] == (not known_before)
    assert linked.front.waiting == 0


def test_a_graph_that_fits_nowhere_does_not_stop_the_front_end() -> None:
    lonely = Lonely()
    lonely.front.add_scan(scans()[0])
    strange = answer(lonely.reports, stamps_ns=np.array([scans()[0].stamp_ns + 1]))
    lonely.front.add_answer(strange)
    lonely.front.add_scan(scans()[1])
    assert lonely.refused["graph_of_another_front_end"] == 1
    assert lonely.reports[-1].stamp_ns == scans()[1].stamp_ns


def test_a_scan_that_cannot_be_worked_on_does_not_stop_the_next(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    linked = LinkedNodes("uspic")
    linked.add_scan(scans()[0])
    with monkeypatch.context() as patch:
        patch.setattr(FrontEnd, "report", lambda *_: 1 / 0)
        with pytest.raises(ZeroDivisionError):
            linked.add_scan(scans()[1])
    linked.add_scan(scans()[2])
    assert len(linked.back.poses) == linked.front.keyframes == 2


@cache
def parts() -> dict[int, Scan]:
    """The parts of the turns, by the stamp that the turn ends at of which they are no part."""
    return {part.stamp_ns: part for part in parts_of(recorded().measurements)}


def part_after(number: int) -> Scan:
    return parts()[scans()[number].end_stamp_ns]


def looking(answered: int) -> Lonely:
    """A front end with so many keyframes that are answered."""
    lonely = Lonely("full")
    for scan in scans()[:answered]:
        lonely.front.add_scan(scan)
        lonely.front.add_answer(answer(lonely.reports))
    return lonely


def test_a_part_corrects_the_pose_as_offline_and_not_the_graph() -> None:
    lonely = looking(2)
    lonely.front.add_part(part_after(1))
    assert len(lonely.corrections) == 3
    front_end = FrontEnd(Configuration(), ESTIMATORS["full"])
    for number in range(2):
        front_end.add_scan(scans()[number])
        known = answer(lonely.reports[: number + 1])
        front_end.correct(known.poses, known.covariances[-1])
    expected = front_end.preview(part_after(1))
    assert expected is not None
    assert lonely.corrections[-1].stamp_ns == expected.stamp_ns
    assert lonely.corrections[-1].pose.tobytes() == expected.pose.tobytes()
    assert lonely.front.keyframes == 2
    assert lonely.front.waiting == 0


def test_a_part_waits_until_the_scan_before_is_answered() -> None:
    lonely = looking(1)
    lonely.front.add_scan(scans()[1])
    lonely.front.add_part(part_after(1))
    assert len(lonely.corrections) == 1
    lonely.front.add_answer(answer(lonely.reports))
    assert len(lonely.corrections) == 3
    assert lonely.corrections[-1].stamp_ns > lonely.corrections[-2].stamp_ns


def test_a_part_that_overtakes_the_scan_before_waits_for_it() -> None:
    lonely = looking(1)
    lonely.front.add_part(part_after(1))
    lonely.front.add_scan(scans()[1])
    assert len(lonely.corrections) == 1
    lonely.front.add_answer(answer(lonely.reports))
    assert len(lonely.corrections) == 3


def test_a_part_whose_turn_is_whole_is_dropped() -> None:
    lonely = looking(2)
    lonely.front.add_scan(scans()[2])
    lonely.front.add_part(part_after(1))
    lonely.front.add_answer(answer(lonely.reports))
    assert len(lonely.corrections) == 3
    lonely.front.add_part(part_after(0))
    assert len(lonely.corrections) == 3
    assert not lonely.refused


def test_a_part_that_comes_twice_is_looked_at_once() -> None:
    lonely = looking(2)
    for _ in range(2):
        lonely.front.add_part(part_after(1))
    assert len(lonely.corrections) == 3


def test_of_parts_of_one_turn_the_newest_counts() -> None:
    stamp_ns = scans()[0].end_stamp_ns
    early, late = [p for p in parts_of(recorded().measurements) if p.stamp_ns == stamp_ns][-2:]
    assert early.end_stamp_ns < late.end_stamp_ns
    lonely = looking(1)
    for part, corrections in ((early, 2), (late, 3), (early, 3)):
        lonely.front.add_part(part)
        assert len(lonely.corrections) == corrections


def test_parts_change_no_constraint() -> None:
    with_parts, without = looking(1), looking(1)
    for number in range(1, 4):
        with_parts.front.add_part(part_after(number - 1))
        for lonely in (with_parts, without):
            lonely.front.add_scan(scans()[number])
            lonely.front.add_answer(answer(lonely.reports))
    assert len(with_parts.corrections) > len(without.corrections)
    for one, other in zip(with_parts.reports, without.reports, strict=True):
        assert one.pose.tobytes() == other.pose.tobytes()
        for edge, same in zip(one.constraints, other.constraints, strict=True):
            assert edge.relative_pose.tobytes() == same.relative_pose.tobytes()
            assert edge.covariance.tobytes() == same.covariance.tobytes()
