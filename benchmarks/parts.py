# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The ideas of ``full``, and how each of them is taken out."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

from benchmarks import neutral
from benchmarks.missions import Changes
from msss_graphslam.core.matching.matchers import SpicMatcher
from msss_graphslam.core.recipes import Recipe

__all__ = ["PARTS", "WHOLE", "Part", "part_named"]

_CORE = "msss_graphslam.core"


def _unchanged(recipe: Recipe) -> Recipe:
    return recipe


@dataclass(frozen=True, slots=True)
class Part:
    """A part by ``name``, and what ``full`` is without it.

    It is taken out by ``values`` of the configuration, by another ``recipe``, or by
    ``replacements``: names in the package and what does nothing in their place. ``changes_scans``
    tells that dead reckoning or segmentation are other ones without it.
    """

    name: str
    left: str
    values: Changes = ()
    recipe: Callable[[Recipe], Recipe] = _unchanged
    replacements: tuple[tuple[str, Any], ...] = ()
    changes_scans: bool = False


WHOLE = Part("", "everything")

PARTS = (
    Part(
        "joint smoothing",
        "the online graph is the result",
        replacements=((f"{_CORE}.logbook.smooth", neutral.smooth),),
    ),
    Part(
        "loop closures",
        "consecutive scans alone",
        recipe=lambda recipe: replace(recipe, closes_loops=False),
    ),
    Part(
        "point-to-line",
        "spIC in its place",
        recipe=lambda recipe: replace(recipe, matcher=SpicMatcher),
    ),
    Part(
        "motion feedback",
        "scans laid out as dead reckoning says",
        replacements=((f"{_CORE}.graph.front_end.MotionFeedback", neutral.NoFeedback),),
    ),
    Part(
        "repeated matching",
        "consecutive scans matched once",
        replacements=((f"{_CORE}.graph.match_rounds.ROUNDS", 1),),
    ),
    Part(
        "correction within a turn",
        "the pose waits for the whole turn",
        replacements=((f"{_CORE}.graph.front_end.previewed", neutral.preview),),
    ),
    Part(
        "wide search",
        "closures from their guess alone",
        replacements=((f"{_CORE}.graph.graph_construction.match_widely", neutral.match_once),),
    ),
    Part(
        "odometry edges",
        "no odometry beside an accepted match",
        replacements=((f"{_CORE}.graph.front_end.FrontEnd.add_scan", neutral.without_odometry),),
    ),
    Part("robust kernel", "least squares", values=(("back_end.robust_width", 0.0),)),
    Part(
        "contradiction test",
        "closures that contradict the graph are accepted",
        values=(("back_end.contradiction", 0.0),),
    ),
    Part(
        "search by overlap",
        "Mahalanobis distance as in equation 11",
        values=(("association.reach", 0.0),),
    ),
    Part(
        "forward and backward",
        "matches whose directions disagree are accepted",
        values=(("matching.disagreement", 1e3), ("matching.disagreement_angle", 1e3)),
    ),
    Part("shift gate", "a match may end anywhere", values=(("matching.shift", 1e9),)),
    Part("overlap gate", "few pairs are enough", values=(("matching.overlap", 0.0),)),
    Part(
        "ghost rejection",
        "every surface is believed",
        values=(("segmentation.ghost_contrast", 80.0),),
        changes_scans=True,
    ),
    Part(
        "several candidates",
        "the nearest echo of a beam",
        values=(("segmentation.candidates", 1),),
        changes_scans=True,
    ),
    Part(
        "surface chains",
        "a surface may be one beam wide",
        replacements=((f"{_CORE}.echoes.ghost_rejection.beams_by_chance", neutral.no_chance),),
        changes_scans=True,
    ),
    Part(
        "gyro within a turn",
        "the heading follows the compass (equation 10)",
        values=(("dead_reckoning.heading_time_constant", 0.5),),
        changes_scans=True,
    ),
    Part(
        "lasting speed error",
        "its noise is white",
        values=(("dead_reckoning.velocity_correlation_time", 0.5),),
        changes_scans=True,
    ),
)
"""Every idea that is taken out, one at a time."""


def part_named(name: str) -> Part:
    """Return the part; KeyError where there is none of that name."""
    return {part.name: part for part in PARTS}[name]
