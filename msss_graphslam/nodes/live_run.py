# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What the back end hands to whoever writes its files, beside the estimate."""

from collections import Counter
from dataclasses import dataclass

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.maps.mapping import OccupancyGrid
from msss_graphslam.core.types import Array
from msss_graphslam.results.record import Cost

__all__ = ["LiveRun", "Maps"]

Maps = tuple[Array, OccupancyGrid]
"""The point map and the grid."""


@dataclass(frozen=True, slots=True)
class LiveRun:
    """What is known of a live run; ``cost`` is the back end's so far."""

    configuration: Configuration
    estimator: str
    refused: Counter[str]
    beams: int
    cost: Cost
