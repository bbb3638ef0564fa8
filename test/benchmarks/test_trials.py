# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Single runs, whole and with a part taken out."""

from collections import Counter
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest
from short_missions import MISSION, shorten_missions

from benchmarks.ablation import EVERYTHING
from benchmarks.alterations import Alteration
from benchmarks.flights import Flight, flown
from benchmarks.missions import accuracy
from benchmarks.parts import PARTS, part_named
from benchmarks.trials import Trial, estimate_of, results
from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core import logbook, pipeline
from msss_graphslam.core.graph import front_end, match_rounds
from msss_graphslam.core.pipeline import Pipeline
from msss_graphslam.core.recipes import ESTIMATORS
from msss_graphslam.core.types import ConstraintKind, Estimate

TRIAL = Trial(MISSION)


@pytest.fixture(scope="module")
def flight() -> Iterator[Flight]:
    with pytest.MonkeyPatch.context() as monkeypatch:
        shorten_missions(monkeypatch)
        yield flown(MISSION)


@pytest.fixture(scope="module")
def whole(flight: Flight) -> Estimate:
    """Return what the estimator makes of the flight, by itself."""
    pipe = Pipeline(Configuration(), ESTIMATORS["full"], Counter())
    for measurement in flight.measurements():
        pipe.process(measurement)
    return pipe.finish()


def without(part: str, flight: Flight) -> Estimate:
    return estimate_of(replace(TRIAL, without=part), flight)


def test_a_trial_is_what_the_estimator_does(flight: Flight, whole: Estimate) -> None:
    ((trial, result),) = results([TRIAL], flight)
    assert trial == TRIAL
    assert result == accuracy(whole, flight.truth)
    assert len(whole.keyframes) > 4


def test_a_shared_front_end_changes_no_result(flight: Flight) -> None:
    names = ["", *(part.name for part in EVERYTHING[:4] if part.name), "surface chains"]
    trials = [replace(TRIAL, without=name) for name in names]
    trials += [replace(TRIAL, estimator=name) for name in ("dead_reckoning", "chen2015")]
    shared = dict(results(trials, flight))
    for trial in trials:
        assert dict(results([trial], flight)) == {trial: shared[trial]}


def test_a_shared_front_end_works_once(flight: Flight, monkeypatch: pytest.MonkeyPatch) -> None:
    made = []

    class Counting(pipeline.DeadReckoning):
        def __init__(self, *arguments: object) -> None:
            made.append(1)
            super().__init__(*arguments)  # type: ignore[arg-type]

    monkeypatch.setattr(pipeline, "DeadReckoning", Counting)
    list(results([replace(TRIAL, without=name) for name in ("", "overlap gate")], flight))
    assert len(made) == 1
    trials = [replace(TRIAL, without=name) for name in ("", "gyro within a turn")]
    list(results([*trials, replace(TRIAL, alteration=Alteration.FOUR_BITS)], flight))
    assert len(made) == 4


@pytest.mark.parametrize("part", [part.name for part in PARTS])
def test_every_part_can_be_taken_out(part: str, flight: Flight) -> None:
    before = (match_rounds.ROUNDS, front_end.MotionFeedback, logbook.smooth)
    estimate = without(part, flight)
    assert np.isfinite(estimate.trajectory.poses).all()
    assert before == (match_rounds.ROUNDS, front_end.MotionFeedback, logbook.smooth)


@pytest.mark.parametrize(
    "part",
    [
        "joint smoothing",
        "point-to-line",
        "motion feedback",
        "repeated matching",
        "gyro within a turn",
        "lasting speed error",
    ],
)
def test_a_part_that_is_taken_out_is_missed(part: str, flight: Flight, whole: Estimate) -> None:
    difference = without(part, flight).trajectory.planar - whole.trajectory.planar
    assert np.abs(difference).max() > 1e-6


def test_without_odometry_edges_only_matches_count(flight: Flight, whole: Estimate) -> None:
    left = without("odometry edges", flight)
    size = {
        estimate: max(
            np.trace(edge.covariance)
            for edge in run.constraints
            if edge.kind is ConstraintKind.ODOMETRY
        )
        for estimate, run in (("whole", whole), ("left", left))
    }
    assert size["left"] > 1e5 * size["whole"]
    matched = [edge for edge in left.constraints if edge.kind is ConstraintKind.CONSECUTIVE]
    assert max(np.trace(edge.covariance) for edge in matched if edge.accepted) < 1.0


def test_without_loops_there_are_none(flight: Flight) -> None:
    kinds = {edge.kind for edge in without("loop closures", flight).constraints}
    assert ConstraintKind.LOOP not in kinds


def test_without_an_imu_the_truth_is_turned_to_the_first_heading(flight: Flight) -> None:
    ((_, result),) = results([replace(TRIAL, alteration=Alteration.NO_IMU)], flight)
    turned = replace(flight, arrays=dict(flight.arrays))
    planar = turned.arrays["truth"] = flight.arrays["truth"].copy()
    planar[:, :2] = planar[:, 1::-1] * [-1.0, 1.0] + 5.0
    planar[:, 5] += 0.5 * np.pi
    ((_, again),) = results([replace(TRIAL, alteration=Alteration.NO_IMU)], turned)
    assert again.anchored == pytest.approx(result.anchored)
    assert result.anchored < 3.0


def test_a_part_that_does_not_exist_is_an_error() -> None:
    with pytest.raises(KeyError, match="wings"):
        part_named("wings")


def test_trials_that_differ_are_called_differently() -> None:
    trials = [
        TRIAL,
        replace(TRIAL, estimator="uspic"),
        replace(TRIAL, values=(("dead_reckoning.surge_speed", 0.2),)),
        replace(TRIAL, values=(("dead_reckoning.surge_speed", 0.0),)),
        replace(TRIAL, alteration=Alteration.NO_IMU),
        *(replace(TRIAL, without=part.name) for part in PARTS),
    ]
    assert len({str(trial) for trial in trials}) == len(trials)
    assert not any(" " in str(trial) or "/" in str(trial) for trial in trials)
