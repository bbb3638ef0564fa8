# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""One simulated mission through the estimators, and how far off they are."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.recipes import ESTIMATORS
from msss_graphslam.evaluation.errors import position_errors, start_end_gap
from msss_graphslam.offline.estimation import estimate
from msss_graphslam.recordings.reader import open_recording
from msss_graphslam.results.record import RunRecord
from msss_graphslam.simulation.echo_model import EchoKind
from msss_graphslam.simulation.recording import simulate
from msss_graphslam.simulation.worlds import world_named

__all__ = ["Accuracy", "Mission", "accuracy", "estimates", "keep_silent"]


@dataclass(frozen=True, slots=True)
class Mission:
    """What is simulated; everything else of a simulation keeps its default."""

    world: str
    echo: EchoKind
    seed: int

    def __str__(self) -> str:
        return f"{self.world}_{self.echo}_{self.seed}"


@dataclass(frozen=True, slots=True)
class Accuracy:
    """How far off a run is [m].

    Mean position errors: ``anchored`` at the start, ``aligned`` to the truth, ``online`` as
    published at the time, anchored; ``gap`` between start and end, and the vehicle's ``true_gap``.
    """

    anchored: float
    aligned: float
    online: float
    gap: float
    true_gap: float


def estimates(
    mission: Mission, estimators: Iterable[str], scratch: Path
) -> Iterator[tuple[str, Accuracy]]:
    """Simulate the mission into a bag under ``scratch``, run the estimators, delete the bag."""
    with TemporaryDirectory(dir=scratch) as folder:
        world = world_named(mission.world)
        bag = simulate(world, mission.seed, Path(folder), echo=mission.echo).bag
        for name in estimators:
            recording = open_recording(bag)
            record = estimate(recording, ESTIMATORS[name], Configuration(), keep_silent)
            yield name, accuracy(record)


def accuracy(record: RunRecord) -> Accuracy:
    """Measure a run against its truth; ValueError where the recording has none."""
    if record.truth is None:
        raise ValueError(f"{record.bag.name} has no ground truth")
    final = position_errors(record.estimate.trajectory, record.truth)
    online = position_errors(record.estimate.online, record.truth)
    return Accuracy(
        anchored=float(np.mean(final.anchored)),
        aligned=float(np.mean(final.aligned)),
        online=float(np.mean(online.anchored)),
        gap=start_end_gap(record.estimate.trajectory),
        true_gap=start_end_gap(record.truth),
    )


def keep_silent(fraction: float, what: str) -> None:
    """Show no progress."""
    del fraction, what
