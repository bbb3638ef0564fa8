# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest

from benchmarks.campaign import Provenance
from benchmarks.consistency import consistency_page, consistency_table
from benchmarks.flights import flown
from benchmarks.honesty import KINDS, STEPS, Statements, _sampled, statements
from benchmarks.missions import Mission
from msss_graphslam.core.types import Trajectory
from msss_graphslam.simulation.echo_model import EchoKind

SPREAD = np.diag([0.1, 0.05, 0.02]) ** 2


def made_up(seed: int, factor: float = 1.0) -> Statements:
    """A mission whose errors are ``factor`` times as large as stated."""
    rng = np.random.default_rng(seed)
    return {
        kind: np.hstack(
            [
                factor * rng.multivariate_normal(np.zeros(3), SPREAD, STEPS),
                np.tile(SPREAD.ravel(), (STEPS, 1)),
            ]
        )
        for kind in KINDS
    }


@pytest.mark.parametrize(("factor", "column"), [(1.0, 2), (2.0, 3), (0.4, 4)])
def test_the_table_says_on_which_side_of_the_band_the_steps_lie(
    factor: float, column: int
) -> None:
    table = consistency_table("pond", [made_up(seed, factor) for seed in range(20)])
    assert [row[0] for row in table.rows] == list(KINDS.values())
    for row in table.rows:
        shares = [int(cell.removesuffix(" %")) for cell in row[2:5]]
        assert shares[column - 2] > 80
        assert float(row[1]) == pytest.approx(factor**2, rel=0.15)


def test_deviations_stand_beside_the_errors() -> None:
    row = consistency_table("pond", [made_up(seed, 2.0) for seed in range(20)]).rows[0]
    assert row[6] == "0.100 m, 0.050 m, 1.15°"
    assert float(row[5].split(" ")[0]) == pytest.approx(0.2, rel=0.1)


def test_the_page_names_its_command_and_the_bands() -> None:
    results = {"pond": [made_up(seed) for seed in range(20)], "paper": [made_up(1)]}
    page = consistency_page(results, Provenance("python -m x", "1.2", "abc"))
    assert "`python -m x`" in page
    assert "0.67 to 1.39 for 20 missions" in page
    assert "0.07 to 3.12 for 1 in" in page
    assert "{{" not in page


def test_steps_take_the_nearest_statement() -> None:
    stamps = np.arange(0, 101, 10) * 1_000_000_000
    truth = Trajectory(stamps, np.zeros((len(stamps), 6)))
    rows = np.arange(11.0)[:, None] * np.ones(12)
    sampled = _sampled(stamps[5:], rows[5:], truth)
    assert sampled.shape == (STEPS, 12)
    assert sampled[0, 0] == 5.0
    assert sampled[-1, 0] == 10.0
    assert (np.diff(sampled[:, 0]) >= 0.0).all()


@pytest.mark.slow
def test_a_mission_states_something_of_every_kind() -> None:
    found = statements(flown(Mission("pond", EchoKind.IDEAL, 1)))
    assert found.keys() == KINDS.keys()
    for rows in found.values():
        assert rows.shape == (STEPS, 12)
        assert np.isfinite(rows).all()
        assert np.abs(rows[:, :2]).max() < 1.0
        assert (np.linalg.eigvalsh(rows[:, 3:].reshape(-1, 3, 3))[:, 0] > 0.0).all()
