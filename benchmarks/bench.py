# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""``make bench``: what every estimator costs, by stage, as a process, and as a mission goes on."""

from argparse import ArgumentParser
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from benchmarks.bags import simulated_bag
from benchmarks.bench_tables import growth_table, process_table, stage_table
from benchmarks.cost import process_cost, scan_costs
from benchmarks.tables import Table, add_folder, publish
from msss_graphslam.cli.console import Console
from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.recipes import ESTIMATORS
from msss_graphslam.offline.estimation import estimate
from msss_graphslam.recordings.reader import open_recording
from msss_graphslam.simulation.worlds import world_named

__all__ = ["main"]

SEED = 1

MARINA_END = 0.8
"""Share of the lap through the marina before which it does not come near its start."""

SHORT_PAST = 0.6
"""Share of the lap where the short past begins."""

ABOUT = """\
Times depend on the machine and on what else it does: compare ratios and shares.

First the paper's basin with real echoes. Then, where loops are closed, the same turns in a lap
through the marina, before it comes back to its start: once with a short, once with a long past.
Association and back end alone see scans that are too far away to be associated; those must cost
next to nothing. A loop closure that is tried costs scan matching, and `chen2015` tries more after
a long past, as its gate widens with the uncertainty of the poses."""


def main(arguments: Sequence[str] | None = None) -> None:
    """Make the bags that are missing, measure, print the tables and write them."""
    parser = ArgumentParser(prog="python -m benchmarks.bench", description=__doc__)
    add_folder(parser)
    folder = parser.parse_args(arguments).out
    folder.mkdir(parents=True, exist_ok=True)
    console = Console()
    tables = _tables(folder, console)
    publish("What a run costs", ABOUT, tables, console, folder / "bench.md")


def _tables(folder: Path, console: Console) -> Iterator[Table]:
    basin = simulated_bag(world_named("paper"), SEED, folder, console)
    yield _processes(basin, folder, console)
    for recipe in ESTIMATORS.values():
        with console.progress() as progress:
            record = estimate(open_recording(basin), recipe, Configuration(), progress)
        yield stage_table(record)
    marina = simulated_bag(replace(world_named("marina"), laps=1), SEED, folder, console)
    for recipe in ESTIMATORS.values():
        if recipe.closes_loops:
            console.remark(f"{recipe.name} scan by scan")
            yield _growth(marina, recipe.name)


def _processes(bag: Path, folder: Path, console: Console) -> Table:
    recording = open_recording(bag)
    costs = {}
    for name in ESTIMATORS:
        console.remark(f"msss run --estimator {name}")
        costs[name] = process_cost(bag, name, folder / name)
    return process_table(costs, (recording.end_ns - recording.start_ns) * 1e-9)


def _growth(bag: Path, estimator: str) -> Table:
    recording = open_recording(bag)
    few, many = (
        scan_costs(recording, estimator, start, MARINA_END) for start in (SHORT_PAST, 0.0)
    )
    return growth_table(estimator, few, many)


if __name__ == "__main__":
    main()
