# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""``make bench``: what every estimator costs on the paper's world, by stage."""

from argparse import ArgumentParser
from collections.abc import Sequence

import numpy as np

from msss_graphslam.cli.console import Console, Row
from msss_graphslam.cli.studies.trial import Mission, records, simulated
from msss_graphslam.results.record import RunRecord
from msss_graphslam.simulation.echo_model import EchoKind
from msss_graphslam.simulation.worlds import WORLD_NAMES

__all__ = ["main"]


def main() -> None:
    """Simulate once, run every estimator and print two tables."""
    parser = ArgumentParser(description=__doc__)
    parser.add_argument("--world", choices=WORLD_NAMES, default="paper")
    arguments = parser.parse_args()
    console = Console()
    console.remark(f"simulating {arguments.world}")
    with simulated(Mission(arguments.world, EchoKind.REAL, seed=1)) as recording:
        runs = []
        for record in records(recording):
            console.remark(f"{record.estimator} done")
            runs.append(record)
    console.table(("milliseconds a scan", *(run.estimator for run in runs)), _stages(runs))
    console.table(("", *(run.estimator for run in runs)), _totals(runs))


def _stages(runs: Sequence[RunRecord]) -> list[Row]:
    names = dict.fromkeys(name for run in runs for name in run.cost.stages)
    return [
        [name.replace("_", " "), *(_milliseconds(run, name) for run in runs)] for name in names
    ]


def _milliseconds(run: RunRecord, stage: str) -> str:
    if stage not in run.cost.stages:
        return ""
    return f"{1e3 * float(np.sum(run.cost.stages[stage])) / len(run.estimate.keyframes):.2f}"


def _totals(runs: Sequence[RunRecord]) -> list[Row]:
    return [
        ["scans", *(str(len(run.estimate.keyframes)) for run in runs)],
        [
            "mission seconds a CPU second",
            *(f"{run.bag.duration / run.cost.cpu:.0f}" for run in runs),
        ],
        ["CPU milliseconds a scan", *(f"{_cpu_milliseconds(run):.1f}" for run in runs)],
        [
            "peak memory of the process so far [MiB]",
            *(f"{run.cost.peak_rss_mib:.0f}" for run in runs),
        ],
    ]


def _cpu_milliseconds(run: RunRecord) -> float:
    return 1e3 * run.cost.cpu / len(run.estimate.keyframes)


if __name__ == "__main__":
    main()
