# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Many trials: what is known is not made again."""

from argparse import ArgumentParser
from dataclasses import replace
from pathlib import Path

import pytest
from short_missions import MISSION

from benchmarks import campaign as campaigns
from benchmarks.campaign import Campaign, call
from benchmarks.missions import Accuracy
from benchmarks.result_cache import PACKAGE, simulation_sources
from benchmarks.trials import Trial

RESULT = Accuracy(0.1, 0.05, 0.2, 0.3, 0.01)
TRIALS = [
    Trial(MISSION),
    Trial(replace(MISSION, seed=4)),
    Trial(MISSION, estimator="uspic"),
]


def campaign(folder: Path) -> Campaign:
    parser = ArgumentParser()
    Campaign.add_options(parser)
    folders = ["--results", str(folder), "--flights", str(folder / "flights")]
    return Campaign.of(parser.parse_args(folders))


class InOneProcess:
    """Stands in for the processes; takes the work as they would."""

    def __init__(self, *_: object) -> None:
        self.taken: list[object] = []

    def Pool(self, *_: object) -> "InOneProcess":  # noqa: N802
        return self

    def __enter__(self) -> "InOneProcess":
        return self

    def __exit__(self, *_: object) -> None:
        pass

    def imap_unordered(self, work, items):  # type: ignore[no-untyped-def]
        self.taken += items
        return map(work, items)


@pytest.fixture
def pool(monkeypatch: pytest.MonkeyPatch) -> InOneProcess:
    stand_in = InOneProcess()
    monkeypatch.setattr(campaigns, "get_context", lambda _: stand_in)
    monkeypatch.setattr(campaigns, "_fly", fly)
    return stand_in


def fly(work, campaign):  # type: ignore[no-untyped-def]
    mission, trials = work
    for trial in trials:
        campaign.results.store(trial, RESULT)
    return mission, len(trials), 1.0


def test_only_what_is_missing_is_run(tmp_path: Path, pool: InOneProcess) -> None:
    known = campaign(tmp_path)
    known.results.store(TRIALS[0], replace(RESULT, anchored=0.7))
    results = known.complete(TRIALS)
    assert pool.taken == [(TRIALS[1].mission, [TRIALS[1]]), (MISSION, [TRIALS[2]])]
    assert [results[trial].anchored for trial in TRIALS] == [0.7, 0.1, 0.1]


def test_trials_of_one_mission_go_together(tmp_path: Path, pool: InOneProcess) -> None:
    campaign(tmp_path).complete(TRIALS)
    assert pool.taken == [
        (MISSION, [TRIALS[0], TRIALS[2]]),
        (TRIALS[1].mission, [TRIALS[1]]),
    ]


def test_what_is_known_whole_starts_no_process(tmp_path: Path, pool: InOneProcess) -> None:
    campaign(tmp_path).complete(TRIALS)
    pool.taken.clear()
    assert campaign(tmp_path).complete(TRIALS) == dict.fromkeys(TRIALS, RESULT)
    assert pool.taken == []


def test_a_simulated_mission_depends_on_no_estimator() -> None:
    used = {str(path.relative_to(PACKAGE.parent)) for path in simulation_sources()}
    assert "msss_graphslam/simulation/vehicle.py" in used
    assert "benchmarks/flights.py" in used
    assert not any(name.startswith("msss_graphslam/core") for name in used)


def test_an_interruption_says_what_is_kept() -> None:
    def interrupted() -> None:
        raise KeyboardInterrupt

    with pytest.raises(SystemExit, match="results so far are kept"):
        call(interrupted)
