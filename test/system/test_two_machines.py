# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The back end topside, the other nodes on the vehicle, and a bad cable between them."""

import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from nodes.processes import Domain, NodeProcess
from system.comparison import assert_same, refused
from system.fleet import Fleet, Surroundings
from system.missions import Mission
from system.two_machines import ENVIRONMENT, Cable, cable, why_not

_REASON = why_not()
pytestmark = [pytest.mark.slow, pytest.mark.skipif(bool(_REASON), reason=_REASON)]

# Longer than the 20 s after which the middleware takes the other machine for gone.
_OUTAGE = 30.0
_EAR = Path(__file__).with_name("ear.py")


@pytest.fixture
def link() -> Iterator[Cable]:
    """Two machines and the cable between them."""
    with cable() as made:
        yield made


@pytest.mark.parametrize("percent", [2, 10])
def test_nothing_is_lost_where_packets_are(
    pond: Mission, own_domain: Domain, link: Cable, tmp_path: Path, percent: int
) -> None:
    with Fleet(_between(own_domain, link), tmp_path / "live") as fleet:
        link.lose(percent)
        fleet.start()
        fleet.run(pond.bag, 20)
        assert link.lost() > 0
    assert_same(fleet.output, pond.offline)
    assert refused(fleet.output) == refused(pond.offline)


def test_a_cable_pulled_out_for_a_while(
    pond: Mission, own_domain: Domain, link: Cable, tmp_path: Path
) -> None:
    """The vehicle waits for the back end's answers, says so, and makes up for it afterwards."""
    domain = _between(own_domain, link)
    command = [*link.vehicle, sys.executable, str(_EAR), "front_end", "waiting_for_back_end_s"]
    with Fleet(domain, tmp_path / "live") as fleet, NodeProcess(command, domain) as ear:
        fleet.start()
        replay = fleet.replay(pond.bag, 10)
        replay.wait_for_output("replayed [3-5]0 %")
        link.pull()
        time.sleep(_OUTAGE)
        ear.wait_for_output(r"waiting_for_back_end_s 2[0-9]")
        link.plug_in()
        fleet.finish(replay)
    assert_same(fleet.output, pond.offline)
    assert refused(fleet.output) == refused(pond.offline)


def _between(domain: Domain, link: Cable) -> Surroundings:
    return Surroundings(domain.number, ENVIRONMENT, {"": link.vehicle, "back_end": link.topside})
