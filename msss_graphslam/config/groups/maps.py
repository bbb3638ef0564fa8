# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The maps."""

from dataclasses import dataclass

from msss_graphslam.config.fields import parameter

__all__ = ["Mapping"]


@dataclass(frozen=True, slots=True)
class Mapping:
    """The maps (equation 5)."""

    resolution: float = parameter(
        0.1, "edge of a cell of the occupancy grid", unit="m", minimum=0.01, maximum=5.0
    )
    free_width: float = parameter(
        0.026,
        "sector about a beam's axis that is free water before the first return",
        unit="rad",
        minimum=0.0,
        maximum=0.5,
    )
    hit_probability: float = parameter(
        0.7, "probability that a cell with a return is occupied", minimum=0.5, maximum=0.999
    )
    miss_probability: float = parameter(
        0.4,
        "probability that a cell before a first return is occupied",
        minimum=0.001,
        maximum=0.5,
    )
