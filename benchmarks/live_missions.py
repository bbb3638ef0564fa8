# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The missions of ``make bench`` for the live nodes, made once and kept."""

from contextlib import AbstractContextManager
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from unittest.mock import patch

from msss_graphslam.cli.console import Console
from msss_graphslam.simulation import inertial
from msss_graphslam.simulation.recording import simulate
from msss_graphslam.simulation.worlds import World, world_named

__all__ = ["SAMPLE", "full_rate_bag"]

SAMPLE = Path(__file__).parent.parent / "bags" / "pond"

_SEED = 1
_LAPS, _BINS, _BEAM_PERIOD, _IMU_PERIOD = 4, 350, 0.04, 0.02


def full_rate_bag(folder: Path, console: Console) -> Path:
    """Return four rounds of the pond with 25 beams/s of 350 bins and 50 Hz of IMU."""
    path = folder / "pond_full_rate"
    if not path.exists():
        console.remark("simulating the pond at full rate")
        with TemporaryDirectory(dir=folder) as unfinished, _fast_imu():
            simulate(_world(), _SEED, Path(unfinished)).bag.rename(path)
    return path


def _world() -> World:
    pond = world_named("pond")
    return replace(
        pond, laps=_LAPS, sonar=replace(pond.sonar, bins=_BINS, beam_period=_BEAM_PERIOD)
    )


def _fast_imu() -> AbstractContextManager[object]:
    # The worlds' IMU has 25 Hz, as the vehicle of the paper; only the cost is of interest here.
    return patch.object(inertial, "_IMU_PERIOD", _IMU_PERIOD)
