# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""``make reproduce``: the paper's numbers beside ours, into docs/reproduction.md."""

import signal
import sys
from argparse import ArgumentParser, ArgumentTypeError, Namespace
from collections.abc import Sequence
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from tempfile import TemporaryDirectory

from benchmarks.missions import Mission, estimates
from benchmarks.page import Provenance, reproduction_page
from benchmarks.result_cache import ResultCache, fingerprint, sources
from benchmarks.study import Study
from msss_graphslam import __version__
from msss_graphslam.cli.console import Console
from msss_graphslam.core.recipes import ESTIMATORS
from msss_graphslam.simulation.echo_model import EchoKind

__all__ = ["main", "missions"]

PAPER_WORLDS = ("paper", "pond")
OTHER_WORLDS = ("marina", "cave")


def main(arguments: Sequence[str] | None = None) -> None:
    """Make what is missing of the results, then the page."""
    options = _parser().parse_args(arguments)
    options.results.mkdir(parents=True, exist_ok=True)
    cache = ResultCache(options.results, fingerprint(sources()))
    planned = missions(options.seeds, options.other_seeds)
    make_missing(planned, cache, options.jobs)
    page = reproduction_page(_study(planned, cache), _provenance(options, cache))
    options.page.write_text(page, encoding="utf-8")


def missions(seeds: int, other_seeds: int) -> list[Mission]:
    """Return the missions, seed by seed, so that an interrupted study has a bit of everything."""
    planned = [
        Mission(world, echo, seed)
        for seed in range(1, seeds + 1)
        for world in PAPER_WORLDS
        for echo in EchoKind
    ]
    planned += [
        Mission(world, echo, seed)
        for seed in range(1, other_seeds + 1)
        for world in OTHER_WORLDS
        for echo in EchoKind
    ]
    return planned


def make_missing(planned: Sequence[Mission], cache: ResultCache, jobs: int) -> None:
    """Fly the missions of which a result is missing, in ``jobs`` processes."""
    missing = [mission for mission in planned if _missing(mission, cache)]
    if not missing:
        return
    done = len(planned) - len(missing)
    with (
        Console().progress() as progress,
        TemporaryDirectory(dir=cache.folder) as scratch,
        get_context("spawn").Pool(jobs, _leave_interrupts_to_the_parent) as pool,
    ):
        progress(done / len(planned), f"{done} of {len(planned)} missions known")
        work = partial(_fly, cache=cache, scratch=Path(scratch))
        for number, mission in enumerate(pool.imap_unordered(work, missing), done + 1):
            progress(number / len(planned), f"{mission}, {number} of {len(planned)}")


def _fly(mission: Mission, cache: ResultCache, scratch: Path) -> Mission:
    for estimator, accuracy in estimates(mission, _missing(mission, cache), scratch):
        cache.store(mission, estimator, accuracy)
    return mission


def _missing(mission: Mission, cache: ResultCache) -> list[str]:
    return [name for name in ESTIMATORS if cache.load(mission, name) is None]


def _study(planned: Sequence[Mission], cache: ResultCache) -> Study:
    results = {
        (mission, name): accuracy
        for mission in planned
        for name in ESTIMATORS
        if (accuracy := cache.load(mission, name)) is not None
    }
    return Study(results)


def _leave_interrupts_to_the_parent() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)


def _provenance(options: Namespace, cache: ResultCache) -> Provenance:
    command = f"python -m benchmarks.reproduce --seeds {options.seeds}"
    return Provenance(
        command=f"{command} --other-seeds {options.other_seeds}",
        version=__version__,
        sources=cache.fingerprint[:12],
    )


def _parser() -> ArgumentParser:
    parser = ArgumentParser(prog="python -m benchmarks.reproduce", description=__doc__)
    parser.add_argument(
        "--seeds", type=_positive, default=8, help="seeds of basin and pond (default 8)"
    )
    parser.add_argument(
        "--other-seeds", type=int, default=2, help="seeds of marina and cave (default 2)"
    )
    parser.add_argument(
        "--jobs", type=_positive, default=2, help="processes side by side (default 2)"
    )
    parser.add_argument(
        "--results",
        type=Path,
        default=Path("reproduction"),
        help="folder of single results; those made by other sources are made anew",
    )
    parser.add_argument("--page", type=Path, default=Path("docs", "reproduction.md"))
    return parser


def _positive(text: str) -> int:
    if not text.isdecimal() or int(text) < 1:
        raise ArgumentTypeError(f"{text!r} must be a whole number from 1 on")
    return int(text)


if __name__ == "__main__":
    try:
        main()
    except KeyboardInterrupt:
        sys.exit("interrupted; the results so far are kept, call again to go on")
