# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""``make ablation``: what each idea of ``full`` is worth, into docs/ablation.md."""

from argparse import ArgumentParser
from collections.abc import Mapping, Sequence
from pathlib import Path

from benchmarks.campaign import Campaign, Provenance, call, positive
from benchmarks.missions import Accuracy, Mission
from benchmarks.page import metres, rendered
from benchmarks.parts import PARTS, WHOLE, Part
from benchmarks.series import Series
from benchmarks.tables import Table
from benchmarks.trials import Trial
from msss_graphslam.simulation.echo_model import EchoKind

__all__ = ["ablation_page", "loss_table", "main", "planned", "trial", "world_table"]

TEMPLATE = "ablation.md.jinja"
WORLDS = ("paper", "pond", "marina", "cave")
LONG = "marina"
"""The world whose missions last three times as long; half the seeds have to do there."""
ECHO = EchoKind.REAL
FIGURES = ("anchored", "aligned", "online")
EVERYTHING = (WHOLE, *PARTS)

Results = Mapping[tuple[str, str], Series]
"""By the part that is missing, and the world."""


def main(arguments: Sequence[str] | None = None) -> None:
    """Make what is missing of the results, then the page."""
    options = _parser().parse_args(arguments)
    campaign = Campaign.of(options)
    known = campaign.complete(planned(options.seeds))
    provenance = campaign.provenance(f"python -m benchmarks.ablation --seeds {options.seeds}")
    page = ablation_page(_results(known, options.seeds), options.seeds, provenance)
    options.page.write_text(page, encoding="utf-8")


def planned(seeds: int) -> list[Trial]:
    """Return the runs, seed by seed, so that an interrupted campaign has a bit of everything."""
    return [
        trial(part, world, seed)
        for seed in range(1, seeds + 1)
        for world in WORLDS
        for part in EVERYTHING
        if seed <= seeds_in(world, seeds)
    ]


def seeds_in(world: str, seeds: int) -> int:
    """Return how many of the seeds fly through a world."""
    return (seeds + 1) // 2 if world == LONG else seeds


def trial(part: Part, world: str, seed: int) -> Trial:
    """Return the run of ``full`` without a part."""
    return Trial(Mission(world, ECHO, seed), without=part.name)


def ablation_page(results: Results, seeds: int, provenance: Provenance) -> str:
    """Return the whole page as Markdown."""
    return rendered(
        TEMPLATE,
        provenance=provenance,
        seeds={world: seeds_in(world, seeds) for world in WORLDS},
        losses={figure: loss_table(figure, results).markdown() for figure in FIGURES},
        worlds={world: world_table(world, results).markdown() for world in WORLDS},
    )


def loss_table(figure: str, results: Results) -> Table:
    """Return for every part and world by which factor a mean error is larger without it."""
    rows = [
        [part.name, part.left, *(_loss(results, part, world, figure) for world in WORLDS)]
        for part in PARTS
    ]
    return Table(figure, ["without", "what is left", *WORLDS], rows)


def world_table(world: str, results: Results) -> Table:
    """Return one world's mean errors [m], with and without every part."""
    rows = []
    for part in EVERYTHING:
        series = results[part.name, world]
        cells = [metres(series.mean(figure)) for figure in FIGURES]
        jump = metres(series.worst("plain_jump"))
        rows.append([part.name or "nothing", *cells, jump, metres(series.mean("gap"))])
    return Table(world, ["without", *FIGURES, "jump", "start to end"], rows)


def _loss(results: Results, part: Part, world: str, figure: str) -> str:
    factor = results[part.name, world].mean(figure) / results[WHOLE.name, world].mean(figure)
    return f"{factor:.2f}"


def _results(known: Mapping[Trial, Accuracy], seeds: int) -> Results:
    return {
        (part.name, world): Series(
            [known[trial(part, world, seed)] for seed in range(1, seeds_in(world, seeds) + 1)]
        )
        for part in EVERYTHING
        for world in WORLDS
    }


def _parser() -> ArgumentParser:
    parser = ArgumentParser(prog="python -m benchmarks.ablation", description=__doc__)
    parser.add_argument("--seeds", type=positive, default=2, help="seeds (default 2)")
    Campaign.add_options(parser)
    parser.add_argument("--page", type=Path, default=Path("docs", "ablation.md"))
    return parser


if __name__ == "__main__":
    call(main)
