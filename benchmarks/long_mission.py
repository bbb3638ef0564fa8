# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""``python -m benchmarks.long_mission``: a day in one basin; what grows, and what does not."""

import multiprocessing
import shutil
from argparse import ArgumentParser
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

from benchmarks.long_figures import WINDOW, agreement_table, draw, end_table, growth_table
from benchmarks.long_run import measure
from benchmarks.long_simulation import LongMission, simulate
from msss_graphslam.cli.console import Console
from msss_graphslam.core.types import Array
from msss_graphslam.simulation.worlds import world_named

__all__ = ["main", "page"]

WORLD, SEED = "pond", 1
SHORT = 300

ABOUT = """\
# Long missions

A vehicle goes round and round in the pond of the paper's Section VIII-B: what a scan costs, what
memory holds and how far the pose is off, from the first scan to the last. Written by

    {command}

on one core; CPU times depend on the machine and on what else it does: look at the ratios.

Motion, IMU (25 Hz), pressure and beams are those of the simulator (seed {seed}), and everything
from dead reckoning on is what `msss run` does, with the estimator `full`. Of the sonar only the
range of each beam is simulated, with noise, lost echoes, outliers and cross-talk: echo profiles of
a day take as long as all the rest and do not grow. That this changes nothing else is shown
[below](#with-echo-profiles).

![growth](long_missions.svg)

## Growth

Each row is about the {window} scans before, the last row about the end. The error is the distance
from the truth, anchored at the start; online is what a subscriber got at the time.

{growth}

Where a place holds many keyframes already and the scan is found there again, it is known
(`core/graph/known_places.py`): the scan is located by the keyframes there, and no later scan is
matched with it. So a scan is compared with a bounded number of others and tied to at most
`association.most` of them, and the front end keeps no points of it. Twelve scans later it leaves
the smoother (`core/graph/released.py`) and stays where it stood to one of the keyframes it was
located by; joint smoothing in the end takes in all of them again. What still grows is the memory
of what was measured and published, of poses and of edges, and the time to go through them. Scans
as the trajectory lays them out in the end are made when they are asked for.

## The whole

{whole}

## With echo profiles

The first {short} scans of the same mission, and once more with every echo profile synthesised
(`ideal`) and segmented. The time a scan is from the last beam of a turn to the corrected pose, the
segmentation of beams before it left out.

{agreement}
"""


def main(arguments: Sequence[str] | None = None) -> None:
    """Simulate what is missing, measure, write page and picture."""
    parser = ArgumentParser(prog="python -m benchmarks.long_mission", description=__doc__)
    parser.add_argument("--scans", type=int, default=10_000, help="turns of the head")
    parser.add_argument(
        "--out", type=Path, default=Path("bench/long_mission"), help="scratch folder"
    )
    parser.add_argument("--docs", type=Path, default=Path("docs"), help="where the page goes")
    options = parser.parse_args(arguments)
    console = Console()
    world = world_named(WORLD)
    measured = []
    for name, mission in (
        ("echoes", LongMission(world, SEED, SHORT, echoes=True)),
        ("short", LongMission(world, SEED, SHORT)),
        ("long", LongMission(world, SEED, options.scans)),
    ):
        console.remark(f"{name}: {mission.scans} scans")
        measured.append(_measured(mission, options.out / name))
    echoes, short, long = measured
    options.docs.mkdir(parents=True, exist_ok=True)
    draw(long, options.docs / "long_missions.svg")
    command = f"python -m benchmarks.long_mission --scans {options.scans}"
    text = page(command, long, short, echoes)
    (options.docs / "long_missions.md").write_text(text, encoding="utf-8")
    growth_table(long).show(console)
    end_table(long).show(console)


def page(
    command: str, long: dict[str, Array], short: dict[str, Array], echoes: dict[str, Array]
) -> str:
    """Return the page as Markdown."""
    return ABOUT.format(
        command=command,
        seed=SEED,
        short=SHORT,
        window=WINDOW,
        growth=growth_table(long).markdown(),
        whole=end_table(long).markdown(),
        agreement=agreement_table(short, echoes).markdown(),
    )


def _measured(mission: LongMission, folder: Path) -> dict[str, Array]:
    """Return the figures of a mission; those of an earlier call are kept."""
    kept = folder.with_suffix(".npz")
    if not kept.exists():
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        _alone(simulate, mission, folder)
        _alone(_measure, mission, folder, kept)
        shutil.rmtree(folder)
    with np.load(kept) as columns:
        return dict(columns)


def _measure(mission: LongMission, folder: Path, output: Path) -> None:
    figures = measure(folder, mission.world.sonar.ranges, "full")
    np.savez(output, allow_pickle=False, mission_s=np.array(mission.duration), **figures)


def _alone(work: Callable[..., None], *arguments: object) -> None:
    """Call in a process of its own, whose memory is that of the work; RuntimeError if it fails."""
    process = multiprocessing.get_context("spawn").Process(target=work, args=arguments)
    process.start()
    process.join()
    if process.exitcode:
        raise RuntimeError(f"{work.__name__} ended with {process.exitcode}")


if __name__ == "__main__":
    main()
