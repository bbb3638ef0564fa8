# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The page that sets the paper's numbers beside ours."""

from pathlib import Path
from typing import Any

import numpy as np
from jinja2 import Environment, FileSystemLoader, StrictUndefined, select_autoescape

from benchmarks.campaign import Provenance
from benchmarks.promises import promises_table
from benchmarks.study import ALIGNED, GAP, ONLINE, POSITION, TRUE_GAP, Study
from benchmarks.tables import Table
from msss_graphslam.core.recipes import ESTIMATORS
from msss_graphslam.core.types import Array
from msss_graphslam.simulation.echo_model import EchoKind

__all__ = ["accuracy_table", "metres", "rendered", "reproduction_page"]

TEMPLATE = "reproduction.md.jinja"

FIGURES = {
    "position error": POSITION,
    "aligned": ALIGNED,
    "known online": ONLINE,
    "start to end": GAP,
}

PUBLISHED = {
    "paper": ("position error", {"dead_reckoning": 6.09, "uspic": 2.53, "chen2015": 0.67}),
    "pond": ("start to end", {"dead_reckoning": 7.77, "uspic": 4.37, "chen2015": 1.08}),
}
"""What the paper states for a world (Section VIII): which figure, and its values [m]."""


def reproduction_page(study: Study, provenance: Provenance) -> str:
    """Return the whole page as Markdown; the study must hold the worlds `paper` and `pond`."""
    tables = {
        world: {str(echo): accuracy_table(study, world, echo).markdown() for echo in EchoKind}
        for world in study.worlds
    }
    return rendered(
        TEMPLATE,
        provenance=provenance,
        seeds={world: study.seeds(world) for world in study.worlds},
        tables=tables,
        promises=promises_table(study).markdown(),
        facts=_facts(study),
    )


def rendered(template: str, **content: Any) -> str:
    """Return a page: one of the templates in this folder, filled in."""
    environment = Environment(
        loader=FileSystemLoader(Path(__file__).parent),
        autoescape=select_autoescape(),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    return environment.get_template(template).render(**content)


def accuracy_table(study: Study, world: str, echo: EchoKind) -> Table:
    """Return a row an estimator: mean, median and worst of each figure over the seeds.

    Where the paper states a figure its values come first, and that figure next.
    """
    stated, published = PUBLISHED.get(world, ("", {}))
    columns = sorted(FIGURES, key=lambda name: name != stated)
    header = ["estimator", *([f"{stated}, paper"] if published else []), *columns]
    rows = []
    for estimator in ESTIMATORS:
        cells = [
            _statistics(study.values(world, echo, estimator, FIGURES[name])) for name in columns
        ]
        if published:
            cells.insert(0, f"{published[estimator]:.2f}" if estimator in published else "")
        rows.append([f"`{estimator}`", *cells])
    return Table(f"{world}, {echo} echoes", header, rows)


def _statistics(values: Array) -> str:
    figures = (np.mean(values), np.median(values), np.max(values))
    return " / ".join(metres(float(figure)) for figure in figures)


def metres(value: float) -> str:
    """Return a length [m] in three digits or to the millimetre."""
    return f"{value:.2f}" if value >= 1.0 else f"{value:.3f}"


def _facts(study: Study) -> dict[str, str]:
    """Return the numbers that the page's text quotes."""

    def spread(estimator: str) -> str:
        errors = study.values("paper", EchoKind.IDEAL, estimator, POSITION)
        return f"{metres(errors.min())} m to {metres(errors.max())} m"

    drift = study.mean("paper", EchoKind.IDEAL, "dead_reckoning", POSITION)
    true_gaps = study.values("pond", EchoKind.IDEAL, "dead_reckoning", TRUE_GAP)
    return {
        "drift": f"{metres(drift)} m",
        "drift_spread": spread("dead_reckoning"),
        "chen2015_spread": spread("chen2015"),
        "true_gap": f"{metres(true_gaps.max())} m",
    }
