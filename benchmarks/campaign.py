# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Many trials: what is missing of their results is made, in several processes."""

import signal
import sys
import time
from argparse import ArgumentParser, ArgumentTypeError, Namespace
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from multiprocessing import get_context
from multiprocessing.pool import Pool
from pathlib import Path

from benchmarks.flights import FlightCache
from benchmarks.missions import Accuracy, Mission
from benchmarks.result_cache import ResultCache, fingerprint, simulation_sources, sources
from benchmarks.trials import Trial, results
from msss_graphslam import __version__
from msss_graphslam.cli.console import Console

__all__ = ["Campaign", "Provenance", "add_flights", "call", "flights_in", "positive"]


@dataclass(frozen=True, slots=True)
class Provenance:
    """What made the results: the ``command``, the package's ``version``, its ``sources``."""

    command: str
    version: str
    sources: str

    @classmethod
    def of(cls, command: str, checksum: str) -> "Provenance":
        """Return that of what this version's sources of a ``fingerprint`` make."""
        return cls(command, __version__, checksum[:12])


@dataclass(frozen=True, slots=True)
class Campaign:
    """Where results and simulated missions are kept, and how many ``jobs`` make them."""

    results: ResultCache
    flights: FlightCache
    jobs: int

    @classmethod
    def of(cls, options: Namespace) -> "Campaign":
        """Return the campaign of a command's options, see ``add_options``."""
        options.results.mkdir(parents=True, exist_ok=True)
        return cls(
            ResultCache(options.results, fingerprint(sources())),
            flights_in(options.flights),
            options.jobs,
        )

    @staticmethod
    def add_options(parser: ArgumentParser) -> None:
        """Add the options that say where and in how many processes."""
        parser.add_argument(
            "--jobs", type=positive, default=2, help="processes side by side (default 2)"
        )
        parser.add_argument(
            "--results",
            type=Path,
            default=Path("reproduction"),
            help="folder of single results; those made by other sources are made anew",
        )
        add_flights(parser)

    def provenance(self, command: str) -> Provenance:
        """Return what a page has to say of its figures' origin."""
        return Provenance.of(command, self.results.fingerprint)

    def complete(self, planned: Sequence[Trial]) -> dict[Trial, Accuracy]:
        """Run the trials of which the result is missing, and return the results of all."""
        missing = [trial for trial in planned if self.results.load(trial) is None]
        if missing:
            self._run(missing, len(planned))
        known = {trial: self.results.load(trial) for trial in planned}
        return {trial: result for trial, result in known.items() if result is not None}

    def _run(self, missing: Sequence[Trial], total: int) -> None:
        """Fly the missions one after the other; one with several trials is loaded once."""
        console, done, cost = Console(), total - len(missing), 0.0
        with console.progress() as progress, _deaf_to_interrupts(self.jobs) as pool:
            progress(done / total, f"{done} of {total} results known")
            work = partial(_fly, campaign=self)
            for mission, count, seconds in pool.imap_unordered(work, _by_mission(missing)):
                done, cost = done + count, cost + seconds
                progress(done / total, f"{mission}, {done} of {total}")
        console.remark(f"{len(missing)} runs in {cost / 60.0:.1f} minutes of CPU time")


def add_flights(parser: ArgumentParser) -> None:
    """Add the option that says where simulated missions are kept."""
    parser.add_argument(
        "--flights",
        type=Path,
        default=Path("reproduction", "flights"),
        help="folder of simulated missions; those of another simulator are made anew",
    )


def flights_in(folder: Path) -> FlightCache:
    """Return the simulated missions kept in a folder, of this simulator alone."""
    return FlightCache(folder, fingerprint(simulation_sources()))


def call(main: Callable[[], None]) -> None:
    """Call a command; interrupted, it says what becomes of the results."""
    try:
        main()
    except KeyboardInterrupt:
        sys.exit("interrupted; the results so far are kept, call again to go on")


def positive(text: str) -> int:
    """Return a whole number from 1 on; ArgumentTypeError for anything else."""
    if not text.isdecimal() or int(text) < 1:
        raise ArgumentTypeError(f"{text!r} must be a whole number from 1 on")
    return int(text)


def _by_mission(trials: Sequence[Trial]) -> list[tuple[Mission, list[Trial]]]:
    grouped: dict[Mission, list[Trial]] = {}
    for trial in trials:
        grouped.setdefault(trial.mission, []).append(trial)
    return list(grouped.items())


def _fly(work: tuple[Mission, Sequence[Trial]], campaign: Campaign) -> tuple[Mission, int, float]:
    """Run a mission's trials and keep their results; return how many, and the CPU time [s]."""
    mission, trials = work
    start = time.process_time()
    for trial, result in results(trials, campaign.flights.get(mission)):
        campaign.results.store(trial, result)
    return mission, len(trials), time.process_time() - start


def _deaf_to_interrupts(jobs: int) -> Pool:
    """Return processes that leave an interruption to their parent, from their first moment on."""
    heard = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        return get_context("spawn").Pool(jobs)
    finally:
        signal.signal(signal.SIGINT, heard)
