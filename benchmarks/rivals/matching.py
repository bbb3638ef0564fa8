# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Scan matchers on the same pairs of scans: accuracy, convergence basin, time."""

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from benchmarks.rivals.aligners import Aligner, Gicp, Ours, PlainIcp
from benchmarks.rivals.scan_pairs import ScanPair, Start, starts
from benchmarks.tables import Table
from msss_graphslam.config.groups import Matching
from msss_graphslam.core.compounding import between
from msss_graphslam.core.matching.matchers import LineMatcher, SpicMatcher
from msss_graphslam.core.types import Array, Scan
from msss_graphslam.offline.estimation import Progress

__all__ = ["STARTS", "Trial", "matching_table", "try_all"]

STARTS = tuple(
    Start(distance, np.deg2rad(angle))
    for distance, angle in ((0.2, 2.0), (0.5, 5.0), (1.0, 10.0), (2.0, 20.0), (4.0, 30.0))
)

CONVERGED, CONVERGED_ANGLE = 0.3, np.deg2rad(3.0)
"""A match this near the truth has found the right walls [m], [rad]."""

OURS = "point-to-line (ours)"


@dataclass(frozen=True, slots=True)
class Trial:
    """What a matcher made of n pairs: ``errors`` (n, 2) [m, rad], CPU time [s].

    ``seconds`` is that of a match, ``preparing`` that of a scan, which is done once.
    """

    errors: Array
    seconds: float
    preparing: float

    @property
    def converged(self) -> Array:
        """Whether each match found the right walls (n,)."""
        near = self.errors < (CONVERGED, CONVERGED_ANGLE)
        return np.asarray(near.all(axis=1))


def aligners() -> dict[str, Aligner]:
    """Return the matchers by name, ours first."""
    return {
        OURS: Ours(LineMatcher(Matching())),
        "spIC (the paper's, ours)": Ours(SpicMatcher(Matching())),
        "small_gicp: GICP": Gicp("GICP"),
        "small_gicp: point to plane": Gicp("PLANE_ICP"),
        "ICP with SciPy's tree": PlainIcp(),
    }


def try_all(
    scans: Sequence[Scan], pairs: Sequence[ScanPair], seed: int, progress: Progress
) -> dict[str, dict[Start, Trial]]:
    """Match the pairs from every start with every matcher; all get the same first guesses."""
    trials: dict[str, dict[Start, Trial]] = {}
    matchers = aligners()
    for number, (name, aligner) in enumerate(matchers.items()):
        progress(number / len(matchers), name)
        clock = time.process_time()
        prepared = [aligner.prepare(scan) for scan in scans]
        preparing = (time.process_time() - clock) / len(scans)
        trials[name] = {
            start: _trial(aligner, prepared, pairs, start, seed, preparing) for start in STARTS
        }
    return trials


def _trial(
    aligner: Aligner,
    prepared: Sequence[object],
    pairs: Sequence[ScanPair],
    start: Start,
    seed: int,
    preparing: float,
) -> Trial:
    errors = []
    guesses = list(starts(pairs, start, np.random.default_rng(seed)))
    clock = time.process_time()
    for pair, guess in guesses:
        reference, current = prepared[pair.reference], prepared[pair.current]
        found = aligner.align(reference, current, guess, start.covariance)
        error = between(pair.displacement, found)
        errors.append((np.hypot(error[0], error[1]), abs(error[2])))
    return Trial(np.array(errors), (time.process_time() - clock) / len(pairs), preparing)


def matching_table(world: str, trials: Mapping[str, Mapping[Start, Trial]]) -> Table:
    """Return a row a matcher; errors and times are those from the nearest start but one."""
    usual = STARTS[1]
    ours = trials[OURS][usual]
    rows = [
        [
            name,
            *(f"{100.0 * by_start[start].converged.mean():.1f}" for start in STARTS),
            *_errors(by_start[usual]),
            f"{1e3 * by_start[usual].preparing:.2f}",
            f"{1e3 * by_start[usual].seconds:.2f}",
            f"{by_start[usual].seconds / ours.seconds:.2f}",
        ]
        for name, by_start in trials.items()
    ]
    pairs = len(ours.errors)
    header = [
        "share of right matches [%]",
        *(f"from {start}" for start in STARTS),
        "median [cm]",
        "95 % [cm]",
        "median [°]",
        "ms per scan",
        "ms per match",
        "time of ours",
    ]
    return Table(f"scan matching, {world}, {pairs} pairs", header, rows)


def _errors(trial: Trial) -> list[str]:
    median, high = np.percentile(trial.errors[:, 0], [50, 95])
    angle = np.rad2deg(np.median(trial.errors[:, 1]))
    return [f"{100.0 * median:.1f}", f"{100.0 * high:.1f}", f"{angle:.2f}"]
