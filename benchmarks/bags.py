# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Simulated bags that a benchmark keeps from one call to the next."""

from pathlib import Path
from tempfile import TemporaryDirectory

from msss_graphslam.cli.console import Console
from msss_graphslam.simulation.recording import simulate
from msss_graphslam.simulation.worlds import World

__all__ = ["simulated_bag"]


def simulated_bag(world: World, seed: int, folder: Path, console: Console) -> Path:
    """Return the world's bag in the folder; one that is there from an earlier call is kept."""
    path = folder / f"{world.name}_{world.laps}_laps_{seed}"
    if not path.exists():
        with console.progress() as progress, TemporaryDirectory(dir=folder) as unfinished:
            bag = simulate(
                world,
                seed,
                Path(unfinished),
                progress=lambda share: progress(share, f"simulating {world.name}"),
            ).bag
            bag.rename(path)
    return path
