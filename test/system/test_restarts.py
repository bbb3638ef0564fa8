# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""A node that is killed in mid-mission and started again joins in."""

from pathlib import Path

import pytest
from nodes.processes import Domain
from system.comparison import assert_near, assert_same, refused
from system.fleet import Fleet
from system.missions import Mission
from system.witness import Witness

pytestmark = pytest.mark.slow

_KEYFRAMES = 6


# What dead reckoning misses while it is away is bridged at the assumed speed. A front end that
# comes back lays the earlier scans out by the poses of then: its edges differ a little.
@pytest.mark.parametrize("name", ["dead_reckoning", "front_end"])
def test_the_way_is_nearly_the_same(
    pond: Mission, own_domain: Domain, tmp_path: Path, name: str
) -> None:
    output = _disturbed(pond, own_domain, tmp_path, name)
    assert_near(output, pond.offline)


# Scan generation gets the beams that it has missed, the back end the whole graph.
@pytest.mark.parametrize("name", ["scan_generation", "back_end"])
def test_the_result_is_the_same(
    pond: Mission, own_domain: Domain, tmp_path: Path, name: str
) -> None:
    output = _disturbed(pond, own_domain, tmp_path, name)
    assert_same(output, pond.offline)
    assert refused(output) == refused(pond.offline)


def _disturbed(pond: Mission, domain: Domain, folder: Path, name: str) -> Path:
    """Return what the nodes make of the mission with one of them killed in it."""
    with Fleet(domain, folder / "live") as fleet, Witness(domain) as witness:
        fleet.start()
        replay = fleet.replay(pond.bag, 20)
        witness.wait_for_keyframes(_KEYFRAMES)
        fleet.kill(name)
        fleet.start(name)
        fleet.finish(replay)
    return fleet.output
