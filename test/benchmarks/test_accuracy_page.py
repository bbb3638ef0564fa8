# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The accuracy under many conditions: its table, its bars, its page."""

import re
from collections import Counter
from dataclasses import replace
from pathlib import Path

import pytest

from benchmarks.accuracy import (
    accuracy_page,
    calibration_table,
    demanded_table,
    main,
    missed_bars,
    planned,
    untuned_table,
)
from benchmarks.campaign import Provenance
from benchmarks.conditions import DEMANDED, REAL_FACTOR, UNTUNED, Condition
from benchmarks.missions import Accuracy
from benchmarks.result_cache import ResultCache, fingerprint, sources
from benchmarks.series import Series, against
from msss_graphslam.config.configuration import Configuration
from msss_graphslam.simulation.echo_model import EchoKind

GOOD = Accuracy(0.1, 0.01, 0.2, 0.05, 0.0, jump=0.9, plain_jump=0.3)
EVERYWHERE = (*DEMANDED, *UNTUNED)
PROVENANCE = Provenance("make accuracy", "1.2.3", "0123456789ab")


def made_up(place: str = "", *worse: Accuracy) -> dict[Condition, Series]:
    """Return good results everywhere, others under one condition."""
    results = {condition: Series([GOOD, GOOD]) for condition in EVERYWHERE}
    if place:
        results[demanded(place)] = Series(worse)
    return results


def demanded(name: str) -> Condition:
    (found,) = (condition for condition in DEMANDED if condition.name.startswith(name))
    return found


def test_no_bar_is_missed_by_good_results() -> None:
    assert missed_bars(made_up()) == []


@pytest.mark.parametrize(
    ("place", "bad", "cell"),
    [
        ("paper, ideal", replace(GOOD, anchored=0.151), "anchored **0.151** (> 0.15)"),
        ("paper, real", replace(GOOD, aligned=0.046), "aligned **0.046** (> 0.045)"),
        ("paper, real", replace(GOOD, online=0.36), "online **0.360** (> 0.35)"),
        ("pond, ideal", replace(GOOD, gap=0.121), "start to end **0.121** (> 0.12)"),
        ("marina, ideal", replace(GOOD, plain_jump=0.51), "jump **0.510** (> 0.5)"),
        ("pond, hull", replace(GOOD, aligned=0.41), "aligned **0.410** (> 0.4)"),
    ],
)
def test_a_bar_that_is_missed_is_named(place: str, bad: Accuracy, cell: str) -> None:
    assert missed_bars(made_up(place, bad)) == [f"{demanded(place).name}: {cell}"]


def test_a_bar_that_is_just_met_is_not_missed() -> None:
    just = replace(GOOD, anchored=0.15, aligned=0.03, online=0.35, plain_jump=0.5)
    assert missed_bars(made_up("paper, ideal", just)) == []


@pytest.mark.parametrize(("worst", "missed"), [(0.0316, 0), (0.0320, 1)])
def test_one_seed_may_not_stand_out(worst: float, missed: int) -> None:
    seeds = [replace(GOOD, aligned=error) for error in (*[0.01] * 7, worst)]
    lines = missed_bars(made_up("pond, with", *seeds))
    assert len([line for line in lines if "worst / mean" in line]) == missed


def test_bars_with_real_echoes_are_wider() -> None:
    for world in ("paper", "pond", "marina", "cave"):
        ideal, real = demanded(f"{world}, ideal").limits, demanded(f"{world}, real").limits
        assert real["aligned"] == pytest.approx(REAL_FACTOR * ideal["aligned"])
    assert real.get("online") == ideal.get("online")


def test_a_value_stands_beside_its_bar() -> None:
    assert against(0.02, None) == "0.020"
    assert against(0.02, 0.02) == "0.020 (≤ 0.02)"
    assert against(2.0, 0.02) == "**2.00** (> 0.02)"


def test_every_setting_is_there_once_and_flies() -> None:
    assert len(set(EVERYWHERE)) == len(EVERYWHERE)
    rows = Counter((condition.world, condition.name) for condition in EVERYWHERE)
    assert max(rows.values()) == 1
    for condition in EVERYWHERE:
        trial = condition.trial(1)
        assert trial.mission.head.bins > 0
        Configuration().with_values(dict(trial.values))
    assert {condition.echo for condition in UNTUNED} == set(EchoKind)


def test_a_run_that_two_rows_share_is_made_once() -> None:
    trials = planned(dict.fromkeys(EVERYWHERE, 2))
    assert len(set(trials)) == len(trials)
    assert len({str(trial) for trial in trials}) == len(trials)
    assert {trial.mission.seed for trial in trials} == {1, 2}
    assert len(trials) < 2 * len(EVERYWHERE)


def test_every_row_has_all_columns() -> None:
    results = made_up()
    for table in (demanded_table(results), untuned_table(UNTUNED, results)):
        assert {len(row) for row in table.rows} == {len(table.header)}
    cells = untuned_table(UNTUNED, results).rows[0][1:]
    assert cells[0] == "0.100 / 0.100"


def test_the_page_holds_everything() -> None:
    page = accuracy_page(made_up("cave, real", replace(GOOD, anchored=5.0)), PROVENANCE)
    assert "cave, real echoes: anchored **5.00** (> 0.6)" in page
    assert "paper, with DVL: 1.00 / 1.00 / 1.00" in page
    for condition in EVERYWHERE:
        assert page.count(f"\n| {condition.name} |") >= 1
    assert not re.search("[{}]", page)
    assert "No bar is missed" not in page
    assert "No bar is missed" in accuracy_page(made_up(), PROVENANCE)


def test_known_results_are_only_written(tmp_path: Path) -> None:
    cache = ResultCache(tmp_path / "results", fingerprint(sources()))
    cache.folder.mkdir()
    for trial in planned(dict.fromkeys(EVERYWHERE, 1)):
        cache.store(trial, GOOD)
    page = tmp_path / "page.md"
    folders = ["--results", str(cache.folder), "--flights", str(tmp_path / "none")]
    main(["--seeds", "1", "--few-seeds", "1", *folders, "--page", str(page)])
    assert "--seeds 1 --few-seeds 1" in page.read_text(encoding="utf-8")
    assert not (tmp_path / "none").exists()


def test_what_a_dvl_tells_of_the_head_is_shown_for_each_condition_with_one() -> None:
    told = replace(GOOD, yaw=1.5, yaw_deviation=0.5, scale=1.004, scale_deviation=0.01)
    results = {
        place: Series([told, replace(told, yaw=2.5)]) if place.dvl else Series([GOOD])
        for place in EVERYWHERE
    }
    table = calibration_table(results)
    assert len(table.rows) == len({place for place in EVERYWHERE if place.dvl}) > 2
    assert table.rows[0][1:] == ["2", "+2.00 ± 0.50", "0.5", "1.0040 ± 0.0100", "0"]
