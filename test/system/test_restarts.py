# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""A node that is killed in mid-mission and started again joins in."""

from pathlib import Path

import pytest
from nodes.processes import Domain
from system.comparison import assert_near, assert_same
from system.fleet import Fleet
from system.missions import Mission
from system.witness import Witness

pytestmark = pytest.mark.slow

_KEYFRAMES = 6
_RATE = 20


@pytest.mark.parametrize("name", ["dead_reckoning", "scan_generation"])
def test_the_way_is_nearly_the_same(
    pond: Mission, own_domain: Domain, tmp_path: Path, name: str
) -> None:
    output = _disturbed(pond, own_domain, tmp_path, name)
    assert_near(output, pond.offline)


@pytest.mark.parametrize("name", ["front_end", "back_end"])
def test_nothing_of_the_graph_is_lost(
    pond: Mission, own_domain: Domain, tmp_path: Path, name: str
) -> None:
    output = _disturbed(pond, own_domain, tmp_path, name)
    assert_same(output, pond.offline)


def _disturbed(pond: Mission, domain: Domain, folder: Path, name: str) -> Path:
    """Return what the nodes make of the mission with one of them killed in it."""
    with Fleet(domain, folder / "live") as fleet, Witness(domain) as witness:
        fleet.start()
        replay = fleet.replay(pond.bag, _RATE)
        witness.wait_for_keyframes(_KEYFRAMES)
        fleet.kill(name)
        fleet.start(name)
        fleet.finish(replay)
    return fleet.output
