# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Parameters of the front end changed on the way."""

from small_mission import estimated

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.front_end import FrontEnd
from msss_graphslam.core.recipes import ESTIMATORS
from msss_graphslam.core.types import Constraint, ConstraintKind, Scan

STRICT = Configuration().with_values({"association.mahalanobis_threshold": 0.0})


def scans() -> tuple[Scan, ...]:
    return estimated("dead_reckoning").first_scans


def loops(*, strict_from: int | None) -> list[Constraint]:
    """Return the loop closures tried, from that scan on with no keyframe near enough."""
    front_end, found = FrontEnd(Configuration(), ESTIMATORS["full"]), []
    for number, scan in enumerate(scans()):
        if number == strict_from:
            front_end.configure(STRICT)
        found += front_end.add_scan(scan)
    return [entry for entry in found if entry.kind is ConstraintKind.LOOP]


def test_changed_parameters_hold_from_the_next_scan_on() -> None:
    unchanged = loops(strict_from=None)
    seconds = sorted({entry.second for entry in unchanged})
    assert len(seconds) > 1
    changed = loops(strict_from=seconds[-1])
    assert [(entry.first, entry.second) for entry in changed] == [
        (entry.first, entry.second) for entry in unchanged if entry.second < seconds[-1]
    ]
