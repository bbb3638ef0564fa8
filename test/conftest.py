# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What all tests share: the order in which they run, and a small simulated bag."""

import numpy as np
import pytest
from hypothesis import settings

from msss_graphslam.simulation.path import Path as Lap
from msss_graphslam.simulation.recording import SimulatedBag, simulate
from msss_graphslam.simulation.settings import SonarSettings
from msss_graphslam.simulation.worlds import World

# No test measures time: a loaded machine is no defect.
settings.register_profile("patient", deadline=None)
settings.load_profile("patient")


def pytest_configure(config: pytest.Config) -> None:
    config.addinivalue_line("markers", "slow: takes seconds; runs after all others")


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    items.sort(key=lambda item: item.get_closest_marker("slow") is not None)


@pytest.fixture(scope="session")
def tank(tmp_path_factory: pytest.TempPathFactory) -> SimulatedBag:
    """A minute in a tank of 9 m x 7 m with a bay, a turn every 4 s."""
    x = [-4.5, 4.5, 4.5, 3.0, 3.0, -4.5]
    y = [-3.5, -3.5, 1.5, 1.5, 3.5, 3.5]
    outline = np.column_stack([x, y])
    angles = np.linspace(0.0, 2.0 * np.pi, 9)[:-1]
    circle = np.column_stack([np.cos(angles), np.sin(angles)])
    world = World(
        name="tank",
        outlines=(outline - circle[0],),
        path=Lap.through(circle - circle[0]),
        laps=1,
        depth=1.0,
        rough=False,
        sonar=SonarSettings(10.0, 100, np.radians(3.6), 0.04),
    )
    return simulate(world, 1, tmp_path_factory.mktemp("tank"))
