# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""A damaged bag."""

from pathlib import Path

import pytest

from msss_graphslam.simulation.recording import SimulatedBag


@pytest.fixture
def truncated(tank: SimulatedBag, tmp_path: Path) -> Path:
    """The tank's bag, cut off in the middle."""
    content = next(tank.bag.glob("*.mcap")).read_bytes()
    path = tmp_path / "truncated.mcap"
    path.write_bytes(content[: len(content) // 2])
    return path
