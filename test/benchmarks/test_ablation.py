# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The ablation: its table and its page."""

import re
from collections import Counter
from pathlib import Path

import pytest

from benchmarks.ablation import (
    EVERYTHING,
    WORLDS,
    Results,
    ablation_page,
    loss_table,
    main,
    planned,
    seeds_in,
    world_table,
)
from benchmarks.campaign import Provenance
from benchmarks.missions import Accuracy
from benchmarks.parts import PARTS
from benchmarks.result_cache import ResultCache, fingerprint, sources
from benchmarks.series import Series

GOOD = Accuracy(0.1, 0.02, 0.2, 0.05, 0.0, jump=0.9, plain_jump=0.3)
WORSE = Accuracy(0.3, 0.02, 0.2, 0.05, 0.0, jump=0.9, plain_jump=0.7)


def made_up() -> Results:
    """Return results of which those without loop closures in the pond are worse."""
    results = {(part.name, world): Series([GOOD, GOOD]) for part in EVERYTHING for world in WORLDS}
    results["loop closures", "pond"] = Series([GOOD, WORSE])
    return results


def test_a_loss_is_a_factor_on_the_mean() -> None:
    rows = {row[0]: row[2:] for row in loss_table("anchored", made_up()).rows}
    assert list(rows["loop closures"]) == ["1.00", "2.00", "1.00", "1.00"]
    assert list(rows["overlap gate"]) == ["1.00"] * len(WORLDS)
    assert set(rows) == {part.name for part in PARTS}


def test_a_world_shows_metres_and_the_largest_jump() -> None:
    rows = {row[0]: list(row[1:]) for row in world_table("pond", made_up()).rows}
    assert rows["loop closures"] == ["0.200", "0.020", "0.200", "0.700", "0.050"]
    assert rows["nothing"] == ["0.100", "0.020", "0.200", "0.300", "0.050"]


def test_every_part_is_taken_out_of_every_world() -> None:
    trials = planned(2)
    flights = Counter((trial.mission.world, trial.mission.seed) for trial in trials)
    assert len(set(trials)) == len(trials)
    assert set(flights.values()) == {1 + len(PARTS)}
    assert set(flights) == {(world, seed) for world in WORLDS for seed in (1, 2)} - {("marina", 2)}


@pytest.mark.parametrize(("seeds", "long"), [(1, 1), (2, 1), (3, 2), (8, 4)])
def test_the_longest_missions_are_flown_half_as_often(seeds: int, long: int) -> None:
    assert seeds_in("marina", seeds) == long
    assert seeds_in("pond", seeds) == seeds


def test_the_page_holds_every_table() -> None:
    page = ablation_page(made_up(), 2, Provenance("make ablation", "1.2.3", "0123"))
    assert "Seeds: paper 2, pond 2, marina 1, cave 2.\n" in page
    for world in WORLDS:
        assert world_table(world, made_up()).markdown() in page
    for figure in ("anchored", "aligned", "online"):
        assert loss_table(figure, made_up()).markdown() in page
    assert not re.search("[{}]", page)


def test_known_results_are_only_written(tmp_path: Path) -> None:
    cache = ResultCache(tmp_path / "results", fingerprint(sources()))
    cache.folder.mkdir()
    for trial in planned(1):
        cache.store(trial, GOOD)
    page = tmp_path / "page.md"
    folders = ["--results", str(cache.folder), "--flights", str(tmp_path / "none")]
    main(["--seeds", "1", *folders, "--page", str(page)])
    assert "--seeds 1`" in page.read_text(encoding="utf-8")
