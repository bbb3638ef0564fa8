# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The parameters that the node ``back_end`` has beside the configuration."""

from dataclasses import dataclass
from typing import Self

from msss_graphslam.core.recipes import Recipe
from msss_graphslam.offline.estimators import recipe_named
from msss_graphslam.ros.parameters import Parameters

__all__ = ["BackEndSettings"]


@dataclass(frozen=True, slots=True)
class BackEndSettings:
    """How to estimate, where to write, of which recording, and how often to draw the map [s]."""

    recipe: Recipe
    output: str
    recording: str
    map_period: float

    @classmethod
    def declared(cls, parameters: Parameters) -> Self:
        """Declare the parameters and return their values."""
        declare = parameters.declare
        return cls(
            recipe_named(declare("estimator", "full", "name of the estimator, as of msss run")),
            declare("output", "", "where save writes its files; '' for none"),
            declare(
                "recording", "", "the bag that is replayed, for the report alone; '' for none"
            ),
            declare(
                "map_period",
                10.0,
                "shortest time between two maps, by wall time [s]",
                minimum=0.1,
                maximum=3600.0,
            ),
        )
