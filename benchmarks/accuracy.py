# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""``make accuracy``: ``full`` under many conditions, beside its bars, into docs/accuracy.md."""

from argparse import ArgumentParser
from collections.abc import Mapping, Sequence
from itertools import groupby
from operator import attrgetter
from pathlib import Path

import numpy as np

from benchmarks.campaign import Campaign, Provenance, call, positive
from benchmarks.conditions import DEMANDED, UNTUNED, Condition
from benchmarks.missions import Accuracy
from benchmarks.page import rendered
from benchmarks.series import Series, against
from benchmarks.tables import Table
from benchmarks.trials import Trial
from msss_graphslam.cli.console import Console
from msss_graphslam.config.configuration import Configuration

__all__ = [
    "accuracy_page",
    "calibration_table",
    "demanded_table",
    "main",
    "missed_bars",
    "planned",
    "untuned_table",
]

TEMPLATE = "accuracy.md.jinja"
UNEVEN = 2.5
"""How far the worst seed may exceed the mean."""
JUMP = 0.5
"""How far the pose known online may jump [m], but for a first far loop closure."""

Results = Mapping[Condition, Series]


def main(arguments: Sequence[str] | None = None) -> None:
    """Make what is missing of the results, then the page."""
    options = _parser().parse_args(arguments)
    campaign = Campaign.of(options)
    seeds = {**dict.fromkeys(DEMANDED, options.seeds), **dict.fromkeys(UNTUNED, options.few_seeds)}
    known = campaign.complete(planned(seeds))
    command = f"python -m benchmarks.accuracy --seeds {options.seeds}"
    provenance = campaign.provenance(f"{command} --few-seeds {options.few_seeds}")
    results = {place: _series(place, count, known) for place, count in seeds.items()}
    options.page.write_text(accuracy_page(results, provenance), encoding="utf-8")
    for line in missed_bars(results):
        Console().line(line)


def planned(seeds: Mapping[Condition, int]) -> list[Trial]:
    """Return the runs, seed by seed, so that an interrupted campaign has a bit of everything."""
    trials = [
        condition.trial(seed)
        for seed in range(1, max(seeds.values()) + 1)
        for condition, count in seeds.items()
        if seed <= count
    ]
    return list(dict.fromkeys(trials))


def accuracy_page(results: Results, provenance: Provenance) -> str:
    """Return the whole page as Markdown."""
    by_world = groupby(UNTUNED, attrgetter("world"))
    return rendered(
        TEMPLATE,
        provenance=provenance,
        seeds=len(results[DEMANDED[0]].results),
        few_seeds=len(results[UNTUNED[0]].results),
        demanded=demanded_table(results).markdown(),
        missed=missed_bars(results),
        dvl=_gains_of_dvl(results),
        calibration=calibration_table(results).markdown(),
        alignment=f"{Configuration().dead_reckoning.alignment_time:g}",
        untuned={
            world: untuned_table(list(conditions), results).markdown()
            for world, conditions in by_world
        },
    )


def demanded_table(results: Results) -> Table:
    """Return the conditions that have bars: each figure's mean beside its bar."""
    header = ["condition", "anchored", "turned", "aligned", "worst / mean", "online", "jump"]
    rows = [[place.name, *_cells(place, results[place])] for place in DEMANDED]
    return Table("Bars", [*header, "after turns", "start to end"], rows)


def missed_bars(results: Results) -> list[str]:
    """Return a line for each bar that is missed."""
    columns = demanded_table(results).header[1:]
    return [
        f"{place.name}: {column} {cell}"
        for place in DEMANDED
        for column, cell in zip(columns, _cells(place, results[place]), strict=True)
        if "**" in cell
    ]


def untuned_table(conditions: Sequence[Condition], results: Results) -> Table:
    """Return one world's settings: mean and worst of each figure."""
    figures = {"anchored": "anchored", "aligned": "aligned", "online": "online"}
    figures |= {"jump": "plain_jump", "start to end": "gap"}
    rows = [
        [place.name, *(results[place].mean_and_worst(figure) for figure in figures.values())]
        for place in conditions
    ]
    return Table(conditions[0].world, ["setting", *figures], rows)


def calibration_table(results: Results) -> Table:
    """Return what is found out of head and speed of sound where there is a DVL."""
    rows = []
    for place in dict.fromkeys([*DEMANDED, *UNTUNED]):
        if place.dvl:
            series = results[place]
            yaw = f"{series.mean('yaw'):+.2f} ± {series.mean('yaw_deviation'):.2f}"
            scale = f"{series.mean('scale'):.4f} ± {series.mean('scale_deviation'):.4f}"
            spreads = [f"{np.std(series.values(name)):.3g}" for name in ("yaw", "scale")]
            rows.append([place.name, str(len(series.results)), yaw, spreads[0], scale, spreads[1]])
    header = ["condition", "seeds", "head turned [deg]", "spread", "ranges times", "spread"]
    return Table("Head against DVL", header, rows)


def _cells(condition: Condition, series: Series) -> list[str]:
    limits = condition.limits
    uneven = max(series.unevenness("anchored"), series.unevenness("aligned"))
    return [
        against(series.mean("anchored"), limits.get("anchored")),
        f"{series.mean('turned'):.2f}",
        against(series.mean("aligned"), limits.get("aligned")),
        against(uneven, UNEVEN),
        against(series.mean("online"), limits.get("online")),
        against(series.worst("plain_jump"), JUMP),
        str(series.worst_of("plain_jump").jump_turns),
        against(series.mean("gap"), limits.get("gap")),
    ]


def _gains_of_dvl(results: Results) -> list[str]:
    """Return a sentence for each world with and without a DVL."""
    lines = []
    for place in DEMANDED:
        if place.dvl:
            (plain,) = (
                other
                for other in DEMANDED
                if (other.world, other.echo, other.noise, other.dvl, other.sonar)
                == (place.world, place.echo, place.noise, False, place.sonar)
            )
            ratios = " / ".join(
                f"{results[place].mean(figure) / results[plain].mean(figure):.2f}"
                for figure in ("anchored", "aligned", "online")
            )
            lines.append(f"{place.name}: {ratios}")
    return lines


def _series(condition: Condition, seeds: int, known: Mapping[Trial, Accuracy]) -> Series:
    return Series([known[trial] for trial in condition.trials(seeds)])


def _parser() -> ArgumentParser:
    parser = ArgumentParser(prog="python -m benchmarks.accuracy", description=__doc__)
    parser.add_argument(
        "--seeds", type=positive, default=8, help="seeds of what has bars (default 8)"
    )
    parser.add_argument(
        "--few-seeds", type=positive, default=2, help="seeds of other settings (default 2)"
    )
    Campaign.add_options(parser)
    parser.add_argument("--page", type=Path, default=Path("docs", "accuracy.md"))
    return parser


if __name__ == "__main__":
    call(main)
