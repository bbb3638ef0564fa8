# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What stands beside our parts does its work, and is measured rightly."""

from dataclasses import replace

import numpy as np
import pytest
from made_scans import standing_scan
from synthetic_run import synthetic_run
from synthetic_scans import basin

from benchmarks.missions import keep_silent
from benchmarks.rivals.graphs import compare_back_ends, graph_table
from benchmarks.rivals.matching import OURS, STARTS, Trial, aligners, matching_table
from benchmarks.rivals.scan_pairs import ScanPair, Start, scan_pairs, starts
from benchmarks.rivals.segmentation import detection, segmentation_table
from msss_graphslam.core.compounding import between, compose
from msss_graphslam.core.types import Trajectory

DISPLACEMENT = np.array([0.6, -0.3, 0.15])
NEAR = Start(0.2, np.deg2rad(2.0))


@pytest.mark.parametrize("name", aligners())
def test_every_matcher_finds_the_displacement(name: str) -> None:
    rng = np.random.default_rng(3)
    walls, aligner = basin(rng), aligners()[name]
    truth = np.array([4.0, 4.0, 0.3])
    places = (truth, compose(truth, DISPLACEMENT))
    reference, current = (
        aligner.prepare(standing_scan(walls, place, place, number, rng))
        for number, place in enumerate(places)
    )
    guess = compose(DISPLACEMENT, np.array([0.1, 0.1, 0.03]))
    found = aligner.align(reference, current, guess, NEAR.covariance)
    assert found == pytest.approx(DISPLACEMENT, abs=0.06)
    assert found != pytest.approx(guess, abs=0.03)


def test_first_guesses_are_as_far_off_as_said_and_the_same_for_all() -> None:
    pairs = [ScanPair(0, number, DISPLACEMENT) for number in range(1, 30)]
    first, again = (list(starts(pairs, NEAR, np.random.default_rng(5))) for _ in range(2))
    offsets = np.array([between(pair.displacement, guess) for pair, guess in first])
    assert np.hypot(*offsets[:, :2].T) == pytest.approx(np.full(29, NEAR.distance))
    assert np.abs(offsets[:, 2]) == pytest.approx(np.full(29, NEAR.angle))
    assert len(np.unique(np.sign(offsets[:, 2]))) == 2
    assert all(np.array_equal(one[1], other[1]) for one, other in zip(first, again, strict=True))


def test_pairs_are_those_that_were_matched_with_their_true_displacement() -> None:
    run = synthetic_run().estimate
    truth = Trajectory(run.trajectory.stamps_ns, run.trajectory.poses)
    pairs = scan_pairs(run, truth, 5, np.random.default_rng(1))
    accepted = {(edge.first, edge.second) for edge in run.constraints if edge.accepted}
    assert len(pairs) == 5
    assert {(pair.reference, pair.current) for pair in pairs} <= accepted


def test_both_back_ends_come_to_the_same_solution() -> None:
    run = synthetic_run().estimate
    costs = compare_back_ends(run, keep_silent)
    assert len(costs.incremental) == len(costs.batch) == len(run.keyframes) - 1
    assert costs.difference < 0.02
    assert [row[0] for row in graph_table("pond", costs).rows][-1] == "all"


def test_a_match_is_right_within_30_cm_and_3_degrees() -> None:
    errors = np.array([[0.29, 0.05], [0.31, 0.05], [0.29, 0.053]])
    trial = Trial(errors, 1.0, 1.0)
    assert trial.converged.tolist() == [True, False, False]
    slower = replace(trial, seconds=3.0)
    by_start = dict.fromkeys(STARTS, trial)
    table = matching_table("pond", {OURS: by_start, "slow": dict.fromkeys(STARTS, slower)})
    assert table.rows[1][-1] == "3.00"
    assert table.rows[0][1] == "33.3"


def test_points_are_judged_by_the_wall_that_their_beam_meets() -> None:
    walls = np.array([5.0, 6.0, np.inf, 7.0])
    seen = np.array([0, 0, 1, 2])
    found = detection("ours", seen, np.array([5.2, 9.0, 6.3, 4.0]), walls, None)
    assert found.found == pytest.approx(1.0 / 3.0)
    assert found.ghosts == pytest.approx(0.75)
    assert found.error == pytest.approx(0.2)
    assert segmentation_table("pond", [found]).rows[0][-1] == ""
