# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The results of many missions through every estimator."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from operator import attrgetter

import numpy as np

from benchmarks.missions import Accuracy, Mission
from msss_graphslam.core.types import Array
from msss_graphslam.simulation.echo_model import EchoKind

__all__ = ["ALIGNED", "GAP", "ONLINE", "POSITION", "TRUE_GAP", "Figure", "Study"]

Figure = Callable[[Accuracy], float]

POSITION: Figure = attrgetter("anchored")
ALIGNED: Figure = attrgetter("aligned")
ONLINE: Figure = attrgetter("online")
GAP: Figure = attrgetter("gap")
TRUE_GAP: Figure = attrgetter("true_gap")


@dataclass(frozen=True, slots=True)
class Study:
    """What came out, by mission and estimator."""

    results: Mapping[tuple[Mission, str], Accuracy]

    @property
    def worlds(self) -> list[str]:
        """The worlds in the order of their first mission."""
        return list(dict.fromkeys(mission.world for mission, _ in self.results))

    def seeds(self, world: str) -> int:
        """Return with how many seeds a world was simulated."""
        return len({mission.seed for mission, _ in self.results if mission.world == world})

    def values(self, world: str, echo: EchoKind, estimator: str, figure: Figure) -> Array:
        """Return one figure of an estimator for every seed (n,) [m]."""
        return np.array(
            [
                figure(accuracy)
                for (mission, name), accuracy in self.results.items()
                if (mission.world, mission.echo, name) == (world, echo, estimator)
            ]
        )

    def mean(self, world: str, echo: EchoKind, estimator: str, figure: Figure) -> float:
        """Return the mean of a figure over the seeds [m]."""
        return float(np.mean(self.values(world, echo, estimator, figure)))
