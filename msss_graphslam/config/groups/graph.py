# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""From scans to a pose graph and its optimum."""

from dataclasses import dataclass

from msss_graphslam.config.fields import parameter

__all__ = ["Association", "BackEnd", "Matching"]


@dataclass(frozen=True, slots=True)
class Association:
    """Which earlier scans may close a loop (Section V)."""

    mahalanobis_threshold: float = parameter(
        9.0, "Mt: largest squared Mahalanobis distance", minimum=0.0, source="Algorithm 3"
    )
    shape_threshold: float = parameter(
        0.45,
        "St: largest distance of the angle histograms (chen2015 only)",
        minimum=0.0,
        maximum=2.0,
        source="Algorithm 3",
    )
    reach: float = parameter(
        0.3,
        "scans this far apart still overlap, as a share of their median range (full only)",
        minimum=0.0,
        maximum=2.0,
    )
    most: int = parameter(
        4, "largest number of loop closures tried for a scan (full only)", minimum=1, maximum=1000
    )


@dataclass(frozen=True, slots=True)
class Matching:
    """How two scans are aligned (Section VI)."""

    iterations: int = parameter(40, "largest number of iterations", minimum=1, maximum=1000)
    compatibility: float = parameter(
        0.95,
        "spIC: probability content of the gate in which two points may be the same",
        minimum=0.1,
        maximum=0.9999,
        source="[30]",
    )
    smallest_step: float = parameter(
        0.001, "spIC: a step shorter than this is the last", unit="m", minimum=1e-9, maximum=0.1
    )
    smallest_turn: float = parameter(
        0.0005, "spIC: and turning less than this", unit="rad", minimum=1e-9, maximum=0.1
    )
    pairing_distance: float = parameter(
        0.5,
        "point-to-line pairs are looked for this far apart at the end, farther at first",
        unit="m",
        minimum=0.01,
        maximum=10.0,
    )
    overlap: float = parameter(
        0.5, "smallest share of points with a pair", minimum=0.0, maximum=1.0
    )
    disagreement: float = parameter(
        0.35, "largest distance of the match forwards and backwards", unit="m", minimum=0.0
    )
    disagreement_angle: float = parameter(
        0.05, "largest angle between the match forwards and backwards", unit="rad", minimum=0.0
    )
    shift: float = parameter(
        16.3,
        "largest squared Mahalanobis distance of a match from its first guess",
        minimum=0.0,
    )


@dataclass(frozen=True, slots=True)
class BackEnd:
    """The incremental smoother (Section III-B)."""

    robust_width: float = parameter(
        1.0,
        "Cauchy width of loop closures in standard deviations, 0 for least squares",
        minimum=0.0,
    )
    contradiction: float = parameter(
        16.3,
        "largest squared Mahalanobis distance of a loop closure from the way between its"
        " keyframes and from the graph, 0 takes every closure (full only)",
        minimum=0.0,
    )
