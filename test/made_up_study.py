# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""A made-up study whose figures can be reckoned in the head."""

from benchmarks.missions import Accuracy, Mission
from benchmarks.study import Study
from msss_graphslam.core.recipes import ESTIMATORS
from msss_graphslam.simulation.echo_model import EchoKind

__all__ = ["made_up_study"]

SEEDS = (1, 2, 6)
SCALE = {"dead_reckoning": 8.0, "uspic": 4.0, "chen2015": 2.0, "full": 0.01}


def made_up_study(*worlds: str, factor: float = 1.0) -> Study:
    """Return position errors of seed times scale; with `real` echoes twice as much.

    Aligned errors are a half of that, the known online 10 times, and gaps 3 times; the vehicle
    itself ends 0.25 m from its start.
    """
    results = {}
    for world in worlds or ("paper", "pond"):
        for echo in EchoKind:
            for seed in SEEDS:
                for name in ESTIMATORS:
                    error = factor * SCALE[name] * seed * (2.0 if echo is EchoKind.REAL else 1.0)
                    results[Mission(world, echo, seed), name] = Accuracy(
                        anchored=error,
                        aligned=0.5 * error,
                        online=10.0 * error,
                        gap=3.0 * error,
                        true_gap=0.25,
                    )
    return Study(results)
