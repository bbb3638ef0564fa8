# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The page that shows what false loop closures do."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from operator import attrgetter

import numpy as np

from benchmarks.campaign import Provenance
from benchmarks.false_injection import FalseKind
from benchmarks.page import rendered
from benchmarks.tables import Table

__all__ = ["Trial", "growth_table", "robustness_page"]

BARS = {0.1: 1.2, 0.3: 2.0}
"""How many times the error may grow with so large a share of false closures."""

Figure = Callable[["Trial"], float]

TEMPLATE = "robustness.md.jinja"


@dataclass(frozen=True, slots=True)
class Trial:
    """One run: how many closures were ``found`` and how many ``false`` ones added; errors [m]."""

    mission: str
    kind: str
    share: float
    plain: bool
    found: int
    false: int
    excluded: int
    withdrawn: int
    online: float
    graph: float
    final: float


def robustness_page(trials: Sequence[Trial], provenance: Provenance) -> str:
    """Return the page as Markdown; the trials must hold the runs without false closures."""
    return rendered(
        TEMPLATE,
        provenance=provenance,
        missions=list(dict.fromkeys(made.mission for made in trials)),
        growth=growth_table(trials).markdown(),
        errors=_error_table(trials).markdown(),
        fates=_fate_table(trials).markdown(),
    )


def growth_table(trials: Sequence[Trial]) -> Table:
    """Return mean and worst growth over the missions by kind and share, and what is allowed."""
    header = ["false closures", "allowed", "online", "final", "least squares online", "final"]
    rows = []
    for kind in FalseKind:
        for share, bar in BARS.items():
            cells = [
                _growth(trials, kind, share, plain, figure)
                for plain in (False, True)
                for figure in (attrgetter("online"), attrgetter("final"))
            ]
            rows.append([f"{kind}, {share:.0%}", f"{bar:.1f}", *cells])
    return Table("growth", header, rows)


def _error_table(trials: Sequence[Trial]) -> Table:
    header = ["mission", "false closures", "online", "final", "least squares online", "final"]
    rows = []
    for mission in dict.fromkeys(made.mission for made in trials):
        for kind, share in [("", 0.0), *((kind, share) for kind in FalseKind for share in BARS)]:
            both = [_one(trials, mission, kind, share, plain) for plain in (False, True)]
            errors = [f"{value:.3f}" for made in both for value in (made.online, made.final)]
            rows.append([mission, f"{kind}, {share:.0%}" if kind else "none", *errors])
    return Table("errors", header, rows)


def _fate_table(trials: Sequence[Trial]) -> Table:
    header = ["mission", "false closures", "found", "added", "contradict odometry", "withdrawals"]
    rows = [
        [made.mission, f"{made.kind}, {made.share:.0%}" if made.kind else "none"]
        + [str(count) for count in (made.found, made.false, made.excluded, made.withdrawn)]
        for made in trials
        if not made.plain
    ]
    return Table("fates", header, rows)


def _growth(trials: Sequence[Trial], kind: str, share: float, plain: bool, figure: Figure) -> str:
    grown = [
        figure(made) / figure(_one(trials, made.mission, "", 0.0, plain))
        for made in trials
        if (made.kind, made.share, made.plain) == (kind, share, plain)
    ]
    return f"{np.mean(grown):.2f} / {np.max(grown):.2f}"


def _one(trials: Sequence[Trial], mission: str, kind: str, share: float, plain: bool) -> Trial:
    wanted = (mission, kind, share, plain)
    return next(
        made for made in trials if (made.mission, made.kind, made.share, made.plain) == wanted
    )
