# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The study: its plan, and the results that it keeps."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from made_up_study import made_up_study
from synthetic_run import synthetic_run

from benchmarks.missions import Accuracy, Mission, accuracy
from benchmarks.reproduce import main, missions
from benchmarks.result_cache import PACKAGE, ResultCache, fingerprint, sources
from benchmarks.trials import Trial
from msss_graphslam.evaluation.errors import position_errors, start_end_gap
from msss_graphslam.simulation.echo_model import EchoKind

MISSION = Mission("pond", EchoKind.REAL, 3)
TRIAL = Trial(MISSION)
RESULT = Accuracy(0.1, 0.05, 0.2, 0.3, 0.01)


def test_a_result_is_found_again(tmp_path: Path) -> None:
    cache = ResultCache(tmp_path, "abc")
    cache.store(TRIAL, RESULT)
    assert cache.load(TRIAL) == RESULT


@pytest.mark.parametrize(
    "other",
    [
        Trial(MISSION, estimator="uspic"),
        Trial(replace(MISSION, seed=4)),
        Trial(replace(MISSION, world="paper")),
        Trial(replace(MISSION, echo=EchoKind.IDEAL)),
        Trial(MISSION, without="loop closures"),
    ],
)
def test_a_result_is_no_other_runs(tmp_path: Path, other: Trial) -> None:
    cache = ResultCache(tmp_path, "abc")
    cache.store(TRIAL, RESULT)
    assert cache.load(other) is None


def test_a_result_of_other_sources_is_thrown_away(tmp_path: Path) -> None:
    ResultCache(tmp_path, "abc").store(TRIAL, RESULT)
    assert ResultCache(tmp_path, "abd").load(TRIAL) is None
    assert list(tmp_path.iterdir()) == []


def test_the_fingerprint_changes_with_every_file(tmp_path: Path) -> None:
    paths = [tmp_path / "a.py", tmp_path / "b.py"]
    for path in paths:
        path.write_text("x = 1\n")
    before = fingerprint(paths)
    paths[1].write_text("x = 2\n")
    assert fingerprint(paths) != before
    assert fingerprint(paths[:1]) != before


def test_results_depend_on_the_estimators_and_not_on_the_commands() -> None:
    names = {str(path.relative_to(PACKAGE)) for path in sources() if PACKAGE in path.parents}
    assert {"core/pipeline.py", "simulation/worlds.py", "evaluation/errors.py"} <= names
    assert not any(name.startswith(("cli/", "evaluation/figures/")) for name in names)


def test_every_seed_flies_through_every_world_with_both_echoes() -> None:
    planned = missions(3, 1)
    assert len(set(planned)) == len(planned) == 3 * 2 * 2 + 1 * 2 * 2
    assert {mission.seed for mission in planned if mission.world == "cave"} == {1}


def test_a_study_that_is_known_whole_only_writes_its_page(tmp_path: Path) -> None:
    cache = ResultCache(tmp_path / "results", fingerprint(sources()))
    cache.folder.mkdir()
    for (mission, name), result in made_up_study().results.items():
        if mission.seed <= 2:
            cache.store(Trial(mission, name), result)
    page = tmp_path / "page.md"
    options = ["--seeds", "2", "--other-seeds", "0", "--results", str(cache.folder)]
    main([*options, "--page", str(page)])
    assert "| `uspic` | 2.53 | 6.00 / 6.00 / 8.00 |" in page.read_text(encoding="utf-8")


@pytest.mark.parametrize("seeds", ["0", "-1", "many"])
def test_a_study_needs_a_seed(seeds: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit, match="2"):
        main(["--seeds", seeds])
    assert "--seeds" in capsys.readouterr().err


def test_accuracy_is_that_of_the_final_and_of_the_online_trajectory() -> None:
    record = synthetic_run()
    assert record.truth is not None
    measured = accuracy(record.estimate, record.truth)
    final = position_errors(record.estimate.trajectory, record.truth)
    assert measured.anchored == pytest.approx(final.anchored.mean())
    assert measured.aligned == pytest.approx(final.aligned.mean())
    assert measured.online > measured.anchored
    assert measured.turned == pytest.approx(abs(np.degrees(final.heading.mean())))
    assert measured.gap == start_end_gap(record.estimate.trajectory)
    assert measured.true_gap == start_end_gap(record.truth)
