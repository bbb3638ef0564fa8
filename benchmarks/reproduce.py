# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""``make reproduce``: the paper's numbers beside ours, into docs/reproduction.md."""

from argparse import ArgumentParser
from collections.abc import Mapping, Sequence
from pathlib import Path

from benchmarks.campaign import Campaign, call, positive
from benchmarks.missions import Accuracy, Mission
from benchmarks.page import reproduction_page
from benchmarks.study import Study
from benchmarks.trials import Trial
from msss_graphslam.core.recipes import ESTIMATORS
from msss_graphslam.simulation.echo_model import EchoKind

__all__ = ["main", "missions"]

PAPER_WORLDS = ("paper", "pond")
OTHER_WORLDS = ("marina", "cave")


def main(arguments: Sequence[str] | None = None) -> None:
    """Make what is missing of the results, then the page."""
    options = _parser().parse_args(arguments)
    campaign = Campaign.of(options)
    planned = missions(options.seeds, options.other_seeds)
    results = campaign.complete([Trial(flown, name) for flown in planned for name in ESTIMATORS])
    command = f"python -m benchmarks.reproduce --seeds {options.seeds}"
    provenance = campaign.provenance(f"{command} --other-seeds {options.other_seeds}")
    page = reproduction_page(_study(results), provenance)
    options.page.write_text(page, encoding="utf-8")


def missions(seeds: int, other_seeds: int) -> list[Mission]:
    """Return the missions, seed by seed, so that an interrupted study has a bit of everything."""
    planned = [
        Mission(world, echo, seed)
        for seed in range(1, seeds + 1)
        for world in PAPER_WORLDS
        for echo in EchoKind
    ]
    planned += [
        Mission(world, echo, seed)
        for seed in range(1, other_seeds + 1)
        for world in OTHER_WORLDS
        for echo in EchoKind
    ]
    return planned


def _study(results: Mapping[Trial, Accuracy]) -> Study:
    return Study({(trial.mission, trial.estimator): known for trial, known in results.items()})


def _parser() -> ArgumentParser:
    parser = ArgumentParser(prog="python -m benchmarks.reproduce", description=__doc__)
    parser.add_argument(
        "--seeds", type=positive, default=8, help="seeds of basin and pond (default 8)"
    )
    parser.add_argument(
        "--other-seeds", type=int, default=2, help="seeds of marina and cave (default 2)"
    )
    Campaign.add_options(parser)
    parser.add_argument("--page", type=Path, default=Path("docs", "reproduction.md"))
    return parser


if __name__ == "__main__":
    call(main)
