# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""One run of an estimator over one simulated mission."""

from collections import Counter
from collections.abc import Iterable, Iterator
from contextlib import ExitStack
from dataclasses import dataclass
from unittest.mock import patch

import numpy as np

from benchmarks.alterations import Alteration, altered
from benchmarks.flights import Flight
from benchmarks.front_memory import FrontMemory
from benchmarks.missions import Accuracy, Changes, Mission, accuracy, spelt
from benchmarks.parts import WHOLE, Part, part_named
from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.compounding import rotation
from msss_graphslam.core.pipeline import Pipeline
from msss_graphslam.core.recipes import ESTIMATORS
from msss_graphslam.core.types import Estimate, Trajectory

__all__ = ["Trial", "estimate_of", "results"]

_Front = tuple[Changes, str, Alteration, bool]


@dataclass(frozen=True, slots=True)
class Trial:
    """A ``mission``, what is altered in its measurements, and who estimates it.

    ``values`` are changes to the default configuration; ``without`` names the part that is taken
    out of the estimator.
    """

    mission: Mission
    estimator: str = "full"
    values: Changes = ()
    alteration: Alteration = Alteration.NONE
    without: str = ""

    def __str__(self) -> str:
        words = [str(self.mission), self.estimator, *spelt(self.values)]
        if self.alteration:
            words.append(str(self.alteration))
        if self.without:
            words.append(f"without={self.without.replace(' ', '-')}")
        return "_".join(words)


def results(trials: Iterable[Trial], flight: Flight) -> Iterator[tuple[Trial, Accuracy]]:
    """Run trials of one mission; what several of them share of the front end is made once."""
    planned = list(trials)
    memories: dict[_Front, FrontMemory] = {}
    fronts = Counter(_front(trial) for trial in planned)
    for trial in planned:
        front = _front(trial)
        memory = memories.setdefault(front, FrontMemory()) if fronts[front] > 1 else None
        yield trial, _measured(trial, flight, memory)


def estimate_of(trial: Trial, flight: Flight, memory: FrontMemory | None = None) -> Estimate:
    """Run the estimator over the flight's measurements, as ``msss run`` does over a bag's."""
    part = _part(trial)
    configuration = Configuration().with_values(dict(trial.values + part.values))
    recipe = part.recipe(ESTIMATORS[trial.estimator])
    with ExitStack() as stack:
        for target, neutral in part.replacements:
            stack.enter_context(patch(target, neutral))
        if memory is not None:
            stack.enter_context(memory.in_use())
        pipeline = Pipeline(configuration, recipe, Counter())
        for measurement in altered(flight.measurements(), trial.alteration):
            pipeline.process(measurement)
        return pipeline.finish()


def _measured(trial: Trial, flight: Flight, memory: FrontMemory | None) -> Accuracy:
    estimate = estimate_of(trial, flight, memory)
    truth = flight.truth
    if trial.alteration is Alteration.NO_IMU:
        truth = _turned(truth, float(estimate.trajectory.planar[0, 2]))
    return accuracy(estimate, truth)


def _turned(truth: Trajectory, heading: float) -> Trajectory:
    """Return the truth turned about its start to begin with ``heading``: no sensor knows north."""
    poses = truth.poses.copy()
    turn = heading - poses[0, 5]
    poses[:, :2] = poses[0, :2] + (poses[:, :2] - poses[0, :2]) @ rotation(turn).T
    poses[:, 5] += turn
    return Trajectory(truth.stamps_ns, np.asarray(poses))


def _part(trial: Trial) -> Part:
    return part_named(trial.without) if trial.without else WHOLE


def _front(trial: Trial) -> _Front:
    """Return what dead reckoning and scans depend on, beside the mission.

    Estimators that go beyond the paper ask for more than scans: for parts of them.
    """
    without = trial.without if _part(trial).changes_scans else ""
    return trial.values, without, trial.alteration, ESTIMATORS[trial.estimator].goes_beyond
