# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What false loop closures do to ``full``: the command that writes docs/robustness.md."""

from argparse import ArgumentParser
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks.campaign import Provenance, add_flights, call, flights_in
from benchmarks.false_injection import FalseClosures, FalseKind
from benchmarks.flights import Flight, FlightCache
from benchmarks.missions import Mission
from benchmarks.result_cache import fingerprint, sources
from benchmarks.robustness_page import Trial, robustness_page
from msss_graphslam.cli.console import Console
from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.graph.front_end import FrontEnd
from msss_graphslam.core.graph.guarded_back_end import CONTRADICTS, GuardedBackEnd
from msss_graphslam.core.logbook import Logbook
from msss_graphslam.core.recipes import ESTIMATORS
from msss_graphslam.core.reckoning.dead_reckoning import DeadReckoning
from msss_graphslam.core.scans.scan_generator import ScanGenerator
from msss_graphslam.core.types import Array, Beam, ConstraintKind, Measurement, Scan
from msss_graphslam.evaluation.errors import interpolate
from msss_graphslam.simulation.echo_model import EchoKind

__all__ = ["Flown", "main", "trial"]

RECIPE = ESTIMATORS["full"]
MISSIONS = (("pond", 1), ("paper", 1), ("cave", 1), ("marina", 1))
SHARES = (0.1, 0.3)
PLAIN = Configuration().with_values({"back_end.robust_width": 0.0, "back_end.contradiction": 0.0})


@dataclass(frozen=True, slots=True)
class Flown:
    """A mission's scans, and the true poses (n, 3) of its keyframes."""

    name: str
    scans: list[Scan]
    truth: Array


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the missions without and with false closures, and write the page."""
    parser = ArgumentParser(prog="python -m benchmarks.false_closures", description=__doc__)
    add_flights(parser)
    parser.add_argument("--page", type=Path, default=Path("docs", "robustness.md"))
    options = parser.parse_args(arguments)
    flights = flights_in(options.flights)
    provenance = Provenance.of(parser.prog, fingerprint(sources()))
    trials = _trials(flights)
    options.page.write_text(robustness_page(trials, provenance), encoding="utf-8")


def _trials(flights: FlightCache) -> list[Trial]:
    trials: list[Trial] = []
    planned = len(MISSIONS) * 2 * (1 + len(FalseKind) * len(SHARES))
    with Console().progress() as progress:
        for world, seed in MISSIONS:
            mission = Mission(world, EchoKind.REAL, seed)
            progress(len(trials) / planned, f"{mission}, scans")
            for made in trials_of(mission_of(str(mission), flights.get(mission))):
                trials.append(made)
                progress(len(trials) / planned, f"{mission}, {len(trials)} of {planned} runs")
    return trials


def trials_of(mission: Flown) -> Iterator[Trial]:
    """Yield the mission's trials: guarded and as plain least squares."""
    for plain in (False, True):
        without = trial(mission, None, 0.0, 0, plain=plain)
        yield without
        for kind in FalseKind:
            for share in SHARES:
                count = round(without.found * share / (1.0 - share))
                yield trial(mission, kind, share, count, plain=plain)


def trial(
    mission: Flown, kind: FalseKind | None, share: float, count: int, *, plain: bool
) -> Trial:
    """Run ``full`` over the scans with ``count`` false closures put in as they come."""
    configuration = PLAIN if plain else Configuration()
    front_end = FrontEnd(configuration, RECIPE)
    back_end = GuardedBackEnd(configuration.back_end, guards=RECIPE.goes_beyond)
    logbook = Logbook(configuration, RECIPE)
    false = FalseClosures(kind, mission.truth, count, 1) if kind else None
    online, found = [], 0
    for number, scan in enumerate(mission.scans):
        logbook.add_scan(scan)
        tried = front_end.add_scan(scan)
        found += sum(edge.accepted and edge.kind is ConstraintKind.LOOP for edge in tried)
        tried += false.at(number) if false else []
        front_end.correct(*back_end.take(front_end.poses[-1], tried))
        online.append(front_end.poses[-1])
    logbook.poses, logbook.constraints = front_end.poses, back_end.tried
    logbook.twist_error = front_end.correction().twist_error
    graph = front_end.poses.copy()
    reasons = Counter(
        edge.refusal
        for edge in back_end.tried
        if false and (edge.first, edge.second) in false.made
    )
    final = np.array([keyframe.pose for keyframe in logbook.finish().keyframes])
    return Trial(
        mission=mission.name,
        kind=str(kind or ""),
        share=share,
        plain=plain,
        found=found,
        false=len(false.made) if false else 0,
        excluded=reasons[CONTRADICTS],
        withdrawn=back_end.withdrawals,
        online=_error(np.array(online), mission.truth),
        graph=_error(graph, mission.truth),
        final=_error(final, mission.truth),
    )


def mission_of(name: str, flight: Flight) -> Flown:
    """Make the scans of a mission, with their true poses."""
    scans = [scan for scan in _scans(flight.measurements()) if scan.usable]
    stamps = np.array([scan.stamp_ns for scan in scans])
    return Flown(name, scans, interpolate(flight.truth, stamps)[0])


def _scans(measurements: Iterable[Measurement]) -> list[Scan]:
    refused: Counter[str] = Counter()
    configuration = Configuration()
    reckoning = DeadReckoning(configuration.dead_reckoning, refused)
    generator = ScanGenerator(configuration, refused)
    scans: list[Scan] = []
    for measurement in measurements:
        for entry in reckoning.process(measurement):
            scans += generator.add_odometry(entry)
        if isinstance(measurement, Beam):
            scans += generator.add_beam(measurement)
    return scans + generator.finish()


def _error(poses: Array, truth: Array) -> float:
    """Return the mean distance [m] of the keyframes from the truth, both begun alike."""
    away = poses[:, :2] - poses[0, :2] - truth[:, :2] + truth[0, :2]
    return float(np.mean(np.hypot(*away.T)))


if __name__ == "__main__":
    call(main)
