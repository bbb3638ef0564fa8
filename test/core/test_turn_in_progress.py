# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""A part of the turn in progress corrects the pose that is known online, and nothing else."""

import pickle
from collections import Counter
from dataclasses import replace

import numpy as np
import pytest
from estimate_checks import assert_same_bytes
from moving_scans import BASIN, BEAMS, CORRIDOR, moving_scans
from small_mission import position_errors, recorded, run

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.compounding import between, compose
from msss_graphslam.core.graph.front_end import FrontEnd
from msss_graphslam.core.graph.turn_in_progress import facing, previewed
from msss_graphslam.core.pipeline import Pipeline
from msss_graphslam.core.recipes import ESTIMATORS
from msss_graphslam.core.scans.scan_generator import ScanGenerator
from msss_graphslam.core.types import Array, Estimate, Scan

FULL = ESTIMATORS["full"]
DOUBT = np.diag([0.03, 0.03, 0.002]) ** 2


def part_of(scan: Scan, beams: int = BEAMS // 3) -> Scan:
    """Return the scan as it stood after its first beams."""
    heard = scan.beam_index < beams
    return replace(
        scan,
        beam_stamps_ns=scan.beam_stamps_ns[:beams],
        end_stamp_ns=int(scan.beam_stamps_ns[beams - 1]),
        reckoned=scan.reckoned[[*range(beams), beams - 1]],
        beam_index=scan.beam_index[heard],
        body_points=scan.body_points[heard],
        body_covariances=scan.body_covariances[heard],
        motion=scan.motion[:beams],
        motion_covariances=scan.motion_covariances[:beams],
        points=scan.points[heard],
        covariances=scan.covariances[heard],
        complete=False,
    )


def in_basin(twist: float = 0.04) -> tuple[FrontEnd, list[Scan], Array]:
    """Return a front end that has heard one turn, both turns, and the keyframes' true poses."""
    scans, truth = moving_scans(BASIN, 2, twist=np.array([twist, 0.01, 0.002]), doubt=DOUBT)
    front_end = FrontEnd(Configuration(), FULL)
    front_end.add_scan(scans[0])
    return front_end, scans, truth


def test_a_part_shows_where_the_vehicle_is_and_how_fast() -> None:
    front_end, scans, truth = in_basin()
    correction = front_end.preview(part_of(scans[1]))
    assert correction is not None
    middle = BEAMS // 6
    assert correction.stamp_ns == scans[1].beam_stamps_ns[middle]
    moved = np.array([0.04, 0.01, 0.002]) * 10.0 * middle / BEAMS
    error = between(compose(truth[1], moved), correction.pose)
    assert np.hypot(*error[:2]) < 0.3 * np.hypot(*truth[1, :2])
    assert correction.twist_error.mean[0] == pytest.approx(0.04, abs=0.012)
    assert np.sqrt(correction.covariance[0, 0]) < 0.2


def test_a_preview_changes_nothing() -> None:
    front_end, scans, _ = in_basin()
    before = pickle.dumps((front_end.nodes, front_end.poses, front_end.layout.feedback))
    assert front_end.preview(part_of(scans[1])) is not None
    assert pickle.dumps((front_end.nodes, front_end.poses, front_end.layout.feedback)) == before
    untouched, _, _ = in_basin()
    for one, other in zip(front_end.add_scan(scans[1]), untouched.add_scan(scans[1]), strict=True):
        assert one.relative_pose.tobytes() == other.relative_pose.tobytes()


def test_along_a_corridor_a_part_says_what_dead_reckoning_says() -> None:
    scans, _ = moving_scans(CORRIDOR, 2, twist=np.array([0.04, 0.0, 0.0]), doubt=DOUBT)
    front_end = FrontEnd(Configuration(), FULL)
    front_end.add_scan(scans[0])
    correction = front_end.preview(part_of(scans[1]))
    assert correction is not None
    along, across = np.sqrt(np.diag(correction.covariance)[:2])
    assert along > 0.9 * 0.03 * 10.0
    assert across < 0.35 * along
    assert abs(correction.pose[0]) < along
    assert np.sqrt(correction.twist_error.covariance[0, 0]) > 0.9 * 0.03


def test_a_part_that_cannot_be_matched_corrects_nothing() -> None:
    front_end, scans, _ = in_basin()
    part = part_of(scans[1])
    elsewhere = replace(part, body_points=part.body_points[::-1] * 2.5)
    assert front_end.preview(elsewhere) is None
    silent = part_of(replace(scans[1], beam_index=scans[1].beam_index + BEAMS))
    assert not len(silent.points)
    assert front_end.preview(silent) is None


@pytest.mark.parametrize(("strange", "as_a_part", "as_a_scan"), [(0, 1, 1), (1, 1, 0), (3, 0, 0)])
def test_a_part_may_have_half_as_many_partners_as_a_scan(
    strange: int, as_a_part: int, as_a_scan: int
) -> None:
    front_end, scans, _ = in_basin()
    part = part_of(scans[1])
    # Walls that the turn before has not seen, beyond those that it has.
    far = np.where(np.arange(len(part.points)) * 8 < strange * len(part.points), 2.0, 1.0)
    part = replace(part, body_points=far[:, None] * part.body_points)
    whole = FULL.matcher(Configuration().matching)
    strict = previewed(part, front_end.nodes[-1], front_end.poses[-1], front_end.layout, whole)
    assert (strict is not None) == as_a_scan
    assert (front_end.preview(part) is not None) == as_a_part


def test_parts_of_turns_that_were_taken_are_late() -> None:
    front_end, scans, _ = in_basin()
    assert front_end.preview(part_of(scans[0])) is None
    front_end.add_scan(scans[1])
    assert front_end.preview(part_of(scans[1])) is None


def test_the_first_wall_seen_again_corrects_across_it() -> None:
    front_end, scans, _ = in_basin()
    correction = front_end.preview(part_of(scans[1], BEAMS // 12))
    assert correction is not None
    small, large = np.sqrt(np.linalg.eigvalsh(correction.covariance[:2, :2]))
    assert small < 0.15
    assert large < 0.35


@pytest.mark.parametrize("estimator", ["dead_reckoning", "uspic", "chen2015"])
def test_the_papers_estimators_know_whole_turns_only(estimator: str) -> None:
    front_end, scans = FrontEnd(Configuration(), ESTIMATORS[estimator]), in_basin()[1]
    front_end.add_scan(scans[0])
    assert front_end.preview(part_of(scans[1])) is None


def test_before_the_first_keyframe_there_is_nothing_to_match_with() -> None:
    assert FrontEnd(Configuration(), FULL).preview(part_of(in_basin()[1][0])) is None


def test_the_reference_keeps_what_lies_where_the_part_looked() -> None:
    scan = moving_scans(BASIN, 1, twist=np.zeros(3))[0][0]
    part = part_of(scan)
    looked = np.arctan2(part.points[:, 1], part.points[:, 0])
    for turned in (0.0, 0.5, -2.5):
        kept = facing(scan, part, turned).points
        angles = np.arctan2(kept[:, 1], kept[:, 0]) - turned - np.median(looked)
        away = np.abs((angles + np.pi) % (2.0 * np.pi) - np.pi)
        assert away.max() < np.pi / 3.0 + 0.1
        assert 0.2 * len(scan.points) < len(kept) < 0.5 * len(scan.points)


def mission(monkeypatch: pytest.MonkeyPatch, *, parts: bool) -> Estimate:
    configuration = Configuration().with_values({"dead_reckoning.surge_speed": 0.16})
    with monkeypatch.context() as patch:
        if not parts:
            patch.setattr(Pipeline, "_preview", lambda _: None)
        return run(recorded().measurements, configuration=configuration)[0]


def test_parts_shorten_the_jumps_and_leave_the_result(monkeypatch: pytest.MonkeyPatch) -> None:
    with_parts, without = (mission(monkeypatch, parts=parts) for parts in (True, False))
    truth = recorded().truth
    assert max_step(with_parts) < 0.8 * max_step(without)
    error = position_errors(with_parts.online, truth).mean()
    assert error < 0.9 * position_errors(without.online, truth).mean()
    assert_same_bytes(replace(with_parts, online=without.online), without)


@pytest.mark.parametrize(("estimator", "asked"), [("full", True), ("chen2015", False)])
def test_only_who_previews_asks_for_parts(
    estimator: str, asked: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    made: list[int] = []
    monkeypatch.setattr(ScanGenerator, "part", lambda _: made.append(1))
    pipeline = Pipeline(Configuration(), ESTIMATORS[estimator], Counter())
    for measurement in recorded().measurements[:2000]:
        pipeline.process(measurement)
    assert bool(made) is asked


def max_step(estimate: Estimate) -> float:
    """Return the longest way between two poses online [m]."""
    return float(np.hypot(*np.diff(estimate.online.planar[:, :2], axis=0).T).max())
