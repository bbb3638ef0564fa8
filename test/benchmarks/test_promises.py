# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What is promised, from both sides of the limits."""

import pytest
from made_up_study import made_up_study

from benchmarks.promises import PROMISES, Promise
from msss_graphslam.simulation.echo_model import EchoKind


def promise(name: str) -> Promise:
    (found,) = (entry for entry in PROMISES if entry.name.startswith(name))
    return found


# `full` has a mean position error of 0.03 m times the factor, and the double with real echoes.
@pytest.mark.parametrize(("factor", "verdict"), [(9.9, "0.297 m"), (10.1, "0.303 m (missed)")])
def test_an_error_may_not_exceed_its_limit(factor: float, verdict: str) -> None:
    study = made_up_study(factor=factor)
    cells = promise("basin: position error of `full`").cells(study, EchoKind.IDEAL)
    assert cells == ("≤ 0.30 m", verdict)


@pytest.mark.parametrize(("factor", "missed"), [(1.9, False), (2.0, True)])
def test_the_gap_in_the_pond_has_its_own_limit(factor: float, missed: bool) -> None:
    study = made_up_study(factor=factor)
    _, reached = promise("pond").cells(study, EchoKind.REAL)
    assert reached.endswith("(missed)") == missed


def test_a_factor_may_not_fall_below_its_limit() -> None:
    gain = promise("basin: error of `uspic` over")
    assert gain.cells(made_up_study(), EchoKind.IDEAL) == ("≥ 1.50", "2.000")
    strict = Promise(gain.name, gain.quantity, {EchoKind.IDEAL: 2.01}, unit="", at_least=True)
    assert strict.cells(made_up_study(), EchoKind.IDEAL) == ("≥ 2.01", "2.000 (missed)")
