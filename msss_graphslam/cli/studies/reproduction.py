# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""``make reproduce``: the paper's numbers beside ours, over many seeds."""

import os
from argparse import ArgumentParser, Namespace
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from pathlib import Path

import numpy as np

from msss_graphslam.cli.console import Console
from msss_graphslam.cli.studies.trial import Mission, Trial, trials
from msss_graphslam.config.documentation import with_section
from msss_graphslam.core.recipes import ESTIMATORS
from msss_graphslam.simulation.echo_model import EchoKind

__all__ = ["main", "tables"]

PAPER_ERRORS = {"dead_reckoning": 6.09, "uspic": 2.53, "chen2015": 0.67}
PAPER_GAPS = {"dead_reckoning": 7.77, "uspic": 4.37, "chen2015": 1.08}
WORLDS = ("paper", "pond")

_BEGIN = "<!-- results: made by `make reproduce` -->"
_END = "<!-- end of results -->"


def main() -> None:
    """Run the study and write its tables into the document."""
    arguments = _arguments()
    missions = [
        Mission(world, echo, seed)
        for world in WORLDS
        for echo in EchoKind
        for seed in range(1, arguments.seeds + 1)
    ]
    with Console().progress() as progress, ProcessPoolExecutor(arguments.jobs) as pool:
        done: list[Trial] = []
        futures = [pool.submit(trials, mission) for mission in missions]
        for number, future in enumerate(as_completed(futures), start=1):
            done += future.result()
            progress(number / len(missions), f"{number} of {len(missions)} missions")
    text = arguments.document.read_text(encoding="utf-8")
    arguments.document.write_text(with_section(text, _BEGIN, _END, tables(done)), encoding="utf-8")


def tables(results: Sequence[Trial]) -> str:
    """Return Markdown: the paper's two experiments, each with both echo models."""
    seeds = len({trial.mission.seed for trial in results})
    return (
        "\n\n".join(
            [
                f"Mean, median and worst over seeds 1 to {seeds}, in metres.",
                "### Simulated basin (Section VIII-A): mean position error",
                _table(results, "paper", lambda trial: trial.anchored, PAPER_ERRORS),
                "### The same after a rotation and a translation onto the truth",
                _table(results, "paper", lambda trial: trial.aligned, {}),
                "### The same as it was known online",
                _table(results, "paper", lambda trial: trial.online, {}),
                "### Pond (Section VIII-B): gap between start and end",
                _table(results, "pond", lambda trial: trial.start_end_gap, PAPER_GAPS),
                "### Pond: mean position error",
                _table(results, "pond", lambda trial: trial.anchored, {}),
            ]
        )
        + "\n"
    )


def _table(
    results: Sequence[Trial],
    world: str,
    figure: Callable[[Trial], float],
    published: dict[str, float],
) -> str:
    rows = [
        "| estimator | paper | ideal: mean | median | worst | real: mean | median | worst |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for name in ESTIMATORS:
        cells = [name, f"{published[name]:.2f}" if name in published else ""]
        for echo in (EchoKind.IDEAL, EchoKind.REAL):
            cells += _statistics(
                [
                    figure(trial)
                    for trial in results
                    if (trial.estimator, trial.mission.world, trial.mission.echo)
                    == (name, world, echo)
                ]
            )
        rows.append(f"| {' | '.join(cells)} |")
    return "\n".join(rows)


def _statistics(values: Sequence[float]) -> Iterator[str]:
    for statistic in (np.mean, np.median, np.max):
        yield f"{float(statistic(values)):.3f}"


def _arguments() -> Namespace:
    parser = ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=8, metavar="N", help="missions of each kind")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), metavar="N")
    parser.add_argument("--document", type=Path, default=Path("docs", "reproduction.md"))
    return parser.parse_args()


if __name__ == "__main__":
    main()
