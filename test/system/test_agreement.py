# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The nodes and the offline run make the same of the same bag, whatever the timing."""

from collections.abc import Callable
from pathlib import Path

import pytest
from nodes.processes import Domain
from system.comparison import assert_same, refused, summary
from system.fleet import Fleet
from system.missions import Mission

from msss_graphslam.nodes.names import SLAM_NODES

pytestmark = pytest.mark.slow


@pytest.mark.parametrize(
    ("world", "rate"), [("pond", 0), ("pond", 20), ("pond", 60), ("paper", 0), ("cave", 0)]
)
def test_nodes_give_the_result_of_the_offline_run(
    mission: Callable[[str], Mission], own_domain: Domain, tmp_path: Path, world: str, rate: int
) -> None:
    with Fleet(own_domain, tmp_path / "live") as fleet:
        fleet.start()
        fleet.run(mission(world).bag, rate)
    assert_same(fleet.output, mission(world).offline)
    made, expected = summary(fleet.output), summary(mission(world).offline)
    assert made["beams"] == expected["beams"]
    assert made["loop_closures"] == expected["loop_closures"]
    assert refused(fleet.output) == refused(mission(world).offline)


def test_the_missions_have_loops_to_agree_on(mission: Callable[[str], Mission]) -> None:
    for world in ("pond", "paper", "cave"):
        made = summary(mission(world).offline)
        assert made["scans"] >= 8
        assert made["loop_closures"]["accepted"] >= 5


def test_the_order_in_which_nodes_start_does_not_matter(
    pond: Mission, own_domain: Domain, tmp_path: Path
) -> None:
    with Fleet(own_domain, tmp_path / "live") as fleet:
        replay = fleet.replay(pond.bag, 0)
        fleet.start(*reversed(SLAM_NODES))
        fleet.finish(replay)
    assert_same(fleet.output, pond.offline)


@pytest.mark.parametrize("late", [("front_end",), ("back_end",), ("front_end", "back_end")])
def test_a_late_start_does_not_matter(
    pond: Mission, own_domain: Domain, tmp_path: Path, late: tuple[str, ...]
) -> None:
    with Fleet(own_domain, tmp_path / "live") as fleet:
        fleet.start(*(name for name in SLAM_NODES if name not in late))
        replay = fleet.replay(pond.bag, 20)
        replay.wait_for_output("replayed 10 %")
        fleet.start(*late)
        fleet.finish(replay)
    assert_same(fleet.output, pond.offline)
