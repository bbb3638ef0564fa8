# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The tables of the reproduction."""

from msss_graphslam.cli.studies.reproduction import WORLDS, tables
from msss_graphslam.cli.studies.trial import Mission, Trial
from msss_graphslam.core.recipes import ESTIMATORS
from msss_graphslam.simulation.echo_model import EchoKind

RESULTS = [
    Trial(
        Mission(world, echo, seed),
        name,
        anchored=seed + 10.0 * (echo is EchoKind.REAL),
        aligned=0.5,
        online=2.0,
        start_end_gap=3.0,
    )
    for world in WORLDS
    for echo in EchoKind
    for seed in (1, 2, 6)
    for name in ESTIMATORS
]


def test_mean_median_and_worst_stand_beside_the_papers_number() -> None:
    rows = tables(RESULTS).splitlines()
    assert "| chen2015 | 0.67 | 3.000 | 2.000 | 6.000 | 13.000 | 12.000 | 16.000 |" in rows
    assert "| uspic | 4.37 | 3.000 | 3.000 | 3.000 | 3.000 | 3.000 | 3.000 |" in rows


def test_what_the_paper_does_not_state_stays_empty() -> None:
    assert "| full |  | 3.000 | 2.000 | 6.000 | 13.000 | 12.000 | 16.000 |" in tables(RESULTS)
