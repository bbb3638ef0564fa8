# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Two vehicles in one domain, each in its namespace, do not hear each other."""

from collections.abc import Callable
from pathlib import Path

import pytest
from nodes.processes import Domain
from system.comparison import assert_same, refused
from system.fleet import Fleet
from system.missions import Mission

pytestmark = pytest.mark.slow


def test_two_vehicles_each_get_their_own_result(
    mission: Callable[[str], Mission], own_domain: Domain, tmp_path: Path
) -> None:
    with (
        Fleet(own_domain, tmp_path / "north", "/north") as north,
        Fleet(own_domain, tmp_path / "south", "/south") as south,
    ):
        north.start()
        south.start()
        replays = [
            (fleet, fleet.replay(mission(world).bag, 0, clock=False))
            for fleet, world in ((north, "pond"), (south, "paper"))
        ]
        for fleet, replay in replays:
            fleet.finish(replay)
    assert_same(north.output, mission("pond").offline)
    assert_same(south.output, mission("paper").offline)
    assert refused(north.output) == refused(mission("pond").offline)
    assert refused(south.output) == refused(mission("paper").offline)
