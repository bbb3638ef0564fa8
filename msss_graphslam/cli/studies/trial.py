# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""One simulated mission through one estimator, and what came out."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.recipes import ESTIMATORS
from msss_graphslam.evaluation.errors import position_errors, start_end_gap
from msss_graphslam.offline.estimation import estimate
from msss_graphslam.recordings.reader import Recording, open_recording
from msss_graphslam.results.record import RunRecord
from msss_graphslam.simulation.echo_model import EchoKind
from msss_graphslam.simulation.recording import simulate
from msss_graphslam.simulation.worlds import world_named

__all__ = ["Mission", "Trial", "records", "simulated", "trials"]


@dataclass(frozen=True, slots=True)
class Mission:
    """What is simulated."""

    world: str
    echo: EchoKind
    seed: int


@dataclass(frozen=True, slots=True)
class Trial:
    """An estimator's mean position errors [m] on a mission, and the gap at its end [m]."""

    mission: Mission
    estimator: str
    anchored: float
    aligned: float
    online: float
    start_end_gap: float


@contextmanager
def simulated(mission: Mission) -> Iterator[Recording]:
    """Give the mission's recording, which is gone afterwards."""
    with TemporaryDirectory() as folder:
        world = world_named(mission.world)
        made = simulate(world, mission.seed, Path(folder), echo=mission.echo)
        yield open_recording(made.bag)


def records(recording: Recording) -> Iterator[RunRecord]:
    """Run every estimator with the default configuration."""
    for recipe in ESTIMATORS.values():
        yield estimate(recording, recipe, Configuration(), lambda _fraction, _what: None)


def trials(mission: Mission) -> list[Trial]:
    """Return how every estimator did on the mission."""
    with simulated(mission) as recording:
        return [_trial(mission, record) for record in records(recording)]


def _trial(mission: Mission, record: RunRecord) -> Trial:
    if record.truth is None:
        raise ValueError(f"{mission}: a simulated recording has a truth")
    errors = position_errors(record.estimate.trajectory, record.truth)
    online = position_errors(record.estimate.online, record.truth)
    return Trial(
        mission,
        record.estimator,
        anchored=float(np.mean(errors.anchored)),
        aligned=float(np.mean(errors.aligned)),
        online=float(np.mean(online.anchored)),
        start_end_gap=start_end_gap(record.estimate.trajectory),
    )
