# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The page that shows what false loop closures do."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from operator import attrgetter

import numpy as np

from benchmarks.false_injection import FalseKind
from benchmarks.tables import Table

__all__ = ["Trial", "growth_table", "robustness_page"]

BARS = {0.1: 1.2, 0.3: 2.0}
"""How many times the error may grow with so large a share of false closures."""

Figure = Callable[["Trial"], float]

_INTRODUCTION = """# False loop closures

This page is made by `python -m benchmarks.false_closures`. To the loop closures that `full` finds,
false ones are added behind all gates, as they would come, with covariances as small as those of
true ones (5 cm, 0.01 rad). A *share* is that of the false ones among all in the graph.

- *anywhere*: two random keyframes, a random displacement.
- *shifted*: two random keyframes, 2 to 5 m and some degrees off.
- *alike*: a stretch of 8 to 16 scans is taken for another one, up to four closures a scan, all
  with one and the same error of 2 to 5 m: they confirm each other.

What stands against them, in the order in which it acts:

1. A closure that the way between its keyframes excludes does not enter the graph
   (`contradicts_odometry`): the consecutive edges alone say where it may lie, and no closure
   can outvote them. The bound is `back_end.contradiction`.
2. A Cauchy kernel on all closures (`back_end.robust_width`).
3. A closure that the graph contradicts three updates in a row is taken out (`withdrawn`), and put
   back when the graph has come to agree with it. The bound is the same.
4. At the end what does not fit is matched again from the graph's estimate.

*Least squares* has neither 1, 2 nor 3.

Position error of the keyframes, anchored at the start, mean over {missions}, all with echoes of a
real head. *Online*: each keyframe when it was new; *final*: after refinement.
"""


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


def robustness_page(trials: Sequence[Trial]) -> str:
    """Return the page as Markdown; the trials must hold the runs without false closures."""
    missions = list(dict.fromkeys(made.mission for made in trials))
    parts = [_INTRODUCTION.format(missions=", ".join(f"`{name}`" for name in missions))]
    parts += [f"## {title}\n\n{table.markdown()}\n" for title, table in _tables(trials)]
    return "\n".join(parts)


def _tables(trials: Sequence[Trial]) -> list[tuple[str, Table]]:
    return [
        ("How many times the error grows", growth_table(trials)),
        ("Errors [m]", _error_table(trials)),
        ("What became of the false closures", _fate_table(trials)),
    ]


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
