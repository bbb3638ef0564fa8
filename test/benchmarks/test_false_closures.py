# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""False loop closures: how they are made, and the page about them."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest
from short_missions import MISSION, shorten_missions

from benchmarks.campaign import Provenance
from benchmarks.false_closures import Flown, mission_of, trial
from benchmarks.false_injection import COVARIANCE, FalseClosures, FalseKind
from benchmarks.flights import Flight, flown
from benchmarks.robustness_page import Trial, growth_table, robustness_page
from msss_graphslam.core.compounding import between, compose
from msss_graphslam.core.graph.constraint_defects import defect
from msss_graphslam.core.types import Array, Constraint

NODES = 90
EVERY_KIND = pytest.mark.parametrize("kind", list(FalseKind))


def truth() -> Array:
    angles = np.linspace(0.0, 4.0 * np.pi, NODES)
    return np.column_stack([20.0 * np.cos(angles), 12.0 * np.sin(angles), angles])


def made(kind: FalseKind, count: int = 60, seed: int = 1) -> list[Constraint]:
    false = FalseClosures(kind, truth(), count, seed)
    return [edge for keyframe in range(NODES) for edge in false.at(keyframe)]


@EVERY_KIND
def test_any_graph_would_take_them(kind: FalseKind) -> None:
    for edge in made(kind):
        assert edge.accepted
        assert edge.first < edge.second - 1
        assert not defect(edge, edge.second + 1)
        np.testing.assert_array_equal(edge.covariance, COVARIANCE)


@EVERY_KIND
def test_there_are_about_as_many_as_wanted(kind: FalseKind) -> None:
    assert 45 <= len(made(kind)) <= 60


@EVERY_KIND
def test_the_same_seed_makes_the_same(kind: FalseKind) -> None:
    first, again, other = made(kind), made(kind), made(kind, seed=2)
    assert [edge.relative_pose.tolist() for edge in first] == [
        edge.relative_pose.tolist() for edge in again
    ]
    assert [edge.first for edge in first] != [edge.first for edge in other]


@pytest.mark.parametrize("kind", [FalseKind.SHIFTED, FalseKind.ALIKE])
def test_they_are_metres_off(kind: FalseKind) -> None:
    poses = truth()
    off = [between(poses[e.first], poses[e.second]) - e.relative_pose for e in made(kind)]
    assert np.median([np.hypot(*row[:2]) for row in off]) > 2.0


def test_those_that_are_near_are_less_than_a_metre_off() -> None:
    poses = truth()
    off = np.array(
        [
            between(poses[edge.first], poses[edge.second]) - edge.relative_pose
            for edge in made(FalseKind.NEAR)
        ]
    )
    distances = np.hypot(*off[:, :2].T)
    assert 0.25 < np.median(distances) < 1.0
    assert distances.max() < 1.4  # the turn acts over a stretch


@pytest.mark.parametrize("kind", [FalseKind.ALIKE, FalseKind.NEAR])
def test_those_of_a_stretch_confirm_each_other(kind: FalseKind) -> None:
    """Where they put the second stretch differs by noise alone."""
    poses = truth()
    edges = made(kind, count=24)
    believed = [compose(poses[edge.first], edge.relative_pose) for edge in edges]
    moves = np.array(
        [
            compose(place, between(poses[edge.second], np.zeros(3)))
            for place, edge in zip(believed, edges, strict=True)
        ]
    )
    assert np.ptp(np.unwrap(moves[:, 2])) < 0.1
    assert np.ptp(moves[:, :2], axis=0).max() < 2.0  # 20 m from the origin, 0.01 rad


def test_those_of_random_pairs_do_not() -> None:
    poses = truth()
    off = np.array(
        [
            (between(poses[e.first], poses[e.second]) - e.relative_pose)[:2]
            for e in made(FalseKind.SHIFTED)
        ]
    )
    assert np.std(off, axis=0).min() > 1.0


def trials() -> list[Trial]:
    """Guarded, errors grow 1.5 times with 30 % and not at all with 10 %; plain, ten times."""
    base = Trial("basin_1", "", 0.0, False, 90, 0, 0, 0, 0.2, 0.1, 0.05)
    rows = [base, replace(base, plain=True)]
    for kind in FalseKind:
        for share, factor in ((0.1, 1.0), (0.3, 1.5)):
            row = replace(base, kind=str(kind), share=share, false=10, excluded=7, withdrawn=3)
            rows.append(replace(row, online=0.2 * factor, final=0.05 * factor))
            rows.append(replace(row, plain=True, online=2.0, final=0.5))
    return rows


def test_the_table_sets_growth_beside_what_is_allowed() -> None:
    table = growth_table(trials())
    assert list(table.rows[0]) == [
        "anywhere, 10%",
        "1.2",
        *["1.00 / 1.00"] * 2,
        *["10.00 / 10.00"] * 2,
    ]
    assert list(table.rows[-1][:4]) == ["near, 30%", "2.0", *["1.50 / 1.50"] * 2]
    assert {len(row) for row in table.rows} == {len(table.header)}


def test_mean_and_worst_are_over_the_missions() -> None:
    other = [replace(row, mission="pond_1", online=row.online * 2) for row in trials()]
    other = [replace(row, online=1.0) if row.kind and not row.plain else row for row in other]
    cells = growth_table([*trials(), *other]).rows[0]
    assert cells[2] == "1.75 / 2.50"


def test_the_page_holds_its_tables_and_its_command() -> None:
    page = robustness_page(trials(), Provenance("python -m some.command", "1.2.3", "0123abcd"))
    assert f"\n{growth_table(trials()).markdown()}\n\n## Errors" in page
    for word in (
        "`python -m some.command`",
        "1.2.3",
        "0123abcd",
        "`basin_1`",
        "| 90 | 10 | 7 | 3 |",
    ):
        assert word in page
    assert "{" not in page


@pytest.fixture(scope="module")
def flight() -> Iterator[Flight]:
    with pytest.MonkeyPatch.context() as monkeypatch:
        shorten_missions(monkeypatch, metres=5.0)
        yield flown(MISSION)


@pytest.fixture(scope="module")
def brief(flight: Flight) -> Flown:
    return mission_of("brief", flight)


def test_the_scans_of_a_mission_stand_at_their_true_poses(flight: Flight, brief: Flown) -> None:
    assert len(brief.scans) > 4
    assert brief.truth.shape == (len(brief.scans), 3)
    for scan, pose in zip(brief.scans, brief.truth, strict=True):
        nearest = np.abs(flight.truth.stamps_ns - scan.stamp_ns).argmin()
        np.testing.assert_allclose(pose[:2], flight.truth.planar[nearest, :2], atol=0.02)


def test_false_closures_are_put_in_and_counted(brief: Flown) -> None:
    without = trial(brief, None, 0.0, 0, plain=False)
    assert (without.mission, without.kind, without.false, without.excluded) == ("brief", "", 0, 0)
    guarded, plain = (
        trial(brief, FalseKind.ANYWHERE, 0.3, 4, plain=plain) for plain in (False, True)
    )
    assert 0 < guarded.false == plain.false <= 4
    assert guarded.excluded == guarded.false
    assert plain.excluded == 0
    assert guarded.online < 2.0 * without.online < plain.online
