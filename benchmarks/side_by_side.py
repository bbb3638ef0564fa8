# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Our matcher, back end and segmentation beside others', on the same data in one run."""

from argparse import ArgumentParser
from collections.abc import Iterator, Sequence
from itertools import chain
from pathlib import Path

import numpy as np

from benchmarks.bags import simulated_bag
from benchmarks.rivals.graphs import compare_back_ends, graph_table
from benchmarks.rivals.matching import matching_table, try_all
from benchmarks.rivals.scan_pairs import scan_pairs
from benchmarks.rivals.segmentation import detections, segmentation_table
from benchmarks.tables import Table, add_folder, publish
from msss_graphslam.cli.console import Console
from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.recipes import ESTIMATORS
from msss_graphslam.offline.estimation import estimate
from msss_graphslam.recordings.reader import open_recording
from msss_graphslam.simulation.worlds import world_named

__all__ = ["main"]

WORLDS = ("paper", "pond", "cave")
SEED = 1
PAIRS = 150

ABOUT = """\
Scans are those of a run of `full` over real echoes, laid out by its trajectory. All matchers get
the same first guesses, so far off in any direction as the table says; a match is right within
0.3 m and 3° of the truth. Errors and times are those from 0.5 m and 5°. Times are CPU times of
one core: compare their ratios."""


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure, print the tables and write them."""
    parser = ArgumentParser(prog="python -m benchmarks.side_by_side", description=__doc__)
    add_folder(parser)
    folder = parser.parse_args(arguments).out
    folder.mkdir(parents=True, exist_ok=True)
    console = Console()
    tables = chain.from_iterable(_tables(world, folder, console) for world in WORLDS)
    publish("Side by side", ABOUT, tables, console, folder / "side_by_side.md")


def _tables(name: str, folder: Path, console: Console) -> Iterator[Table]:
    world = world_named(name)
    recording = open_recording(simulated_bag(world, SEED, folder, console))
    with console.progress() as progress:
        record = estimate(recording, ESTIMATORS["full"], Configuration(), progress)
        run, truth = record.estimate, record.truth
        if truth is None:
            raise ValueError(f"{recording.path} has no ground truth")
        pairs = scan_pairs(run, truth, PAIRS, np.random.default_rng(SEED))
        scans = [keyframe.scan for keyframe in run.keyframes]
        trials = try_all(scans, pairs, SEED, progress)
        costs = compare_back_ends(run, progress)
    yield matching_table(name, trials)
    yield graph_table(name, costs)
    yield segmentation_table(name, detections(recording, run.first_scans, truth, world))


if __name__ == "__main__":
    main()
