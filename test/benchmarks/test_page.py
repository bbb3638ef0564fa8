# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The page of the reproduction."""

import re

from made_up_study import made_up_study

from benchmarks.campaign import Provenance
from benchmarks.page import accuracy_table, reproduction_page
from benchmarks.promises import promises_table
from msss_graphslam.simulation.echo_model import EchoKind

PROVENANCE = Provenance("make reproduce", "1.2.3", "0123456789ab")


def test_mean_median_and_worst_stand_beside_the_papers_error() -> None:
    table = accuracy_table(made_up_study(), "paper", EchoKind.IDEAL)
    rows = {row[0]: row[1:] for row in table.rows}
    assert table.header[1:3] == ["position error, paper", "position error"]
    assert list(rows["`uspic`"][:3]) == ["2.53", "12.00 / 8.00 / 24.00", "6.00 / 4.00 / 12.00"]


def test_the_pond_shows_the_gap_first() -> None:
    table = accuracy_table(made_up_study(), "pond", EchoKind.REAL)
    rows = {row[0]: row[1:] for row in table.rows}
    assert table.header[1:3] == ["start to end, paper", "start to end"]
    assert list(rows["`chen2015`"][:2]) == ["1.08", "36.00 / 24.00 / 72.00"]


def test_what_the_paper_does_not_state_stays_empty() -> None:
    table = accuracy_table(made_up_study(), "paper", EchoKind.IDEAL)
    assert table.rows[-1][:2] == ["`full`", ""]


def test_a_world_of_ours_has_no_column_of_the_paper() -> None:
    table = accuracy_table(made_up_study("marina"), "marina", EchoKind.IDEAL)
    assert not any("paper" in name for name in table.header)
    assert {len(row) for row in table.rows} == {len(table.header)}


def test_the_page_holds_every_table_and_where_it_comes_from() -> None:
    study = made_up_study("paper", "pond", "marina", "cave")
    page = reproduction_page(study, PROVENANCE)
    for world in study.worlds:
        for echo in EchoKind:
            assert accuracy_table(study, world, echo).markdown() in page
    assert promises_table(study).markdown() in page
    for word in ("make reproduce", "version 1.2.3", "0123456789ab", "8.00 m to 48.00 m"):
        assert word in page


def test_worlds_that_were_not_simulated_are_not_spoken_of() -> None:
    page = reproduction_page(made_up_study(), PROVENANCE)
    assert not re.search("marina|cave|{|}", page)
