# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Missions of a minute for the tests of benchmarks."""

from dataclasses import replace

import pytest

from benchmarks import missions
from benchmarks.missions import Mission
from msss_graphslam.simulation.echo_model import EchoKind
from msss_graphslam.simulation.worlds import World, world_named

__all__ = ["MISSION", "shorten_missions"]

MISSION = Mission("paper", EchoKind.IDEAL, 3)


def shorten_missions(monkeypatch: pytest.MonkeyPatch, metres: float = 3.0) -> None:
    """Let every mission end after a few metres, with coarse settings of the sonar."""

    def short_world(name: str) -> World:
        world = world_named(name)
        path = world.path
        count = int(50 * metres)
        path = replace(
            path,
            points=path.points[:count],
            tangents=path.tangents[:count],
            arc_lengths=path.arc_lengths[:count],
        )
        coarse = replace(world.sonar, bins=120, step=3.0 * world.sonar.step)
        return replace(world, path=path, laps=1, sonar=coarse)

    monkeypatch.setattr(missions, "world_named", short_world)
