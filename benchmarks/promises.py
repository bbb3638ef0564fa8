# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What this package promises of its accuracy, and whether it holds."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from benchmarks.study import ALIGNED, GAP, POSITION, Figure, Study
from benchmarks.tables import Table
from msss_graphslam.simulation.echo_model import EchoKind

__all__ = ["PROMISES", "Promise", "promises_table"]


@dataclass(frozen=True, slots=True)
class Promise:
    """A quantity in its ``unit`` and its ``limits`` by echo model.

    It may not exceed them, unless ``at_least``: then it may not fall below.
    """

    name: str
    quantity: Callable[[Study, EchoKind], float]
    limits: Mapping[EchoKind, float]
    unit: str = " m"
    at_least: bool = False

    def cells(self, study: Study, echo: EchoKind) -> tuple[str, str]:
        """Return the limit and what was reached."""
        value, limit = self.quantity(study, echo), self.limits[echo]
        kept = value >= limit if self.at_least else value <= limit
        bound = "≥" if self.at_least else "≤"
        verdict = "" if kept else " (missed)"
        return f"{bound} {limit:.2f}{self.unit}", f"{value:.3f}{self.unit}{verdict}"


def _mean_of_full(world: str, figure: Figure) -> Callable[[Study, EchoKind], float]:
    return lambda study, echo: study.mean(world, echo, "full", figure)


def _gain(worse: str, better: str) -> Callable[[Study, EchoKind], float]:
    """Return by which factor one estimator's position error in the basin is larger."""

    def factor(study: Study, echo: EchoKind) -> float:
        first, second = (study.mean("paper", echo, name, POSITION) for name in (worse, better))
        return first / second

    return factor


def _limits(ideal: float, real: float) -> dict[EchoKind, float]:
    return {EchoKind.IDEAL: ideal, EchoKind.REAL: real}


PROMISES = (
    Promise(
        "basin: error of `dead_reckoning` over that of `uspic`",
        _gain("dead_reckoning", "uspic"),
        _limits(1.5, 1.5),
        unit="",
        at_least=True,
    ),
    Promise(
        "basin: error of `uspic` over that of `chen2015`",
        _gain("uspic", "chen2015"),
        _limits(1.5, 1.5),
        unit="",
        at_least=True,
    ),
    Promise(
        "basin: position error of `full`", _mean_of_full("paper", POSITION), _limits(0.30, 0.40)
    ),
    Promise("basin: the same, aligned", _mean_of_full("paper", ALIGNED), _limits(0.10, 0.15)),
    Promise("pond: start to end of `full`", _mean_of_full("pond", GAP), _limits(0.25, 0.35)),
)


def promises_table(study: Study) -> Table:
    """Return each promise with its limits beside the means over the seeds."""
    rows = [
        [
            promise.name,
            *promise.cells(study, EchoKind.IDEAL),
            *promise.cells(study, EchoKind.REAL),
        ]
        for promise in PROMISES
    ]
    header = ["mean over the seeds", "ideal: limit", "reached", "real: limit", "reached"]
    return Table("promises", header, rows)
