# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What false loop closures do to ``full``: the command that writes docs/robustness.md."""

from argparse import ArgumentParser
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks.false_injection import FalseClosures, FalseKind
from benchmarks.flights import flown
from benchmarks.missions import Mission
from benchmarks.robustness_page import Trial, robustness_page
from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.graph.front_end import FrontEnd
from msss_graphslam.core.graph.guarded_back_end import CONTRADICTS, GuardedBackEnd
from msss_graphslam.core.logbook import Logbook
from msss_graphslam.core.recipes import ESTIMATORS
from msss_graphslam.core.reckoning.dead_reckoning import DeadReckoning
from msss_graphslam.core.scans.scan_generator import ScanGenerator
from msss_graphslam.core.types import Array, Beam, ConstraintKind, Measurement, Scan
from msss_graphslam.simulation.echo_model import EchoKind

__all__ = ["Flown", "main", "trial"]

RECIPE = ESTIMATORS["full"]
MISSIONS = (("pond", 1), ("paper", 1), ("cave", 1))
SHARES = (0.1, 0.3)
PLAIN = Configuration().with_values({"back_end.robust_width": 0.0, "back_end.contradiction": 0.0})


@dataclass(frozen=True, slots=True)
class Flown:
    """A mission's scans, and the true poses (n, 3) of its keyframes."""

    name: str
    scans: list[Scan]
    truth: Array


def main(arguments: Sequence[str] | None = None) -> None:
    """Fly the missions without and with false closures, and write the page."""
    parser = ArgumentParser(prog="python -m benchmarks.false_closures", description=__doc__)
    parser.add_argument("--page", type=Path, default=Path("docs", "robustness.md"))
    options = parser.parse_args(arguments)
    trials: list[Trial] = []
    for world, seed in MISSIONS:
        mission = flown_mission(Mission(world, EchoKind.REAL, seed))
        trials += trials_of(mission)
        options.page.write_text(robustness_page(trials), encoding="utf-8")


def trials_of(mission: Flown) -> list[Trial]:
    """Return the mission's trials: guarded and as plain least squares."""
    trials = []
    for plain in (False, True):
        without = trial(mission, None, 0.0, 0, plain=plain)
        trials.append(without)
        for kind in FalseKind:
            for share in SHARES:
                count = round(without.found * share / (1.0 - share))
                trials.append(trial(mission, kind, share, count, plain=plain))
    return trials


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


def flown_mission(mission: Mission) -> Flown:
    """Simulate a mission, and make its scans."""
    flight = flown(mission)
    scans = [scan for scan in _scans(flight.measurements()) if scan.usable]
    stamps = [scan.stamp_ns for scan in scans]
    truth = flight.truth
    poses = np.column_stack(
        [np.interp(stamps, truth.stamps_ns, column) for column in _unwrapped(truth.planar).T]
    )
    return Flown(str(mission), scans, poses)


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


def _unwrapped(poses: Array) -> Array:
    return np.column_stack([poses[:, :2], np.unwrap(poses[:, 2])])


def _error(poses: Array, truth: Array) -> float:
    """Return the mean distance [m] of the keyframes from the truth, both begun alike."""
    away = poses[:, :2] - poses[0, :2] - truth[:, :2] + truth[0, :2]
    return float(np.mean(np.hypot(*away.T)))


if __name__ == "__main__":
    main()
