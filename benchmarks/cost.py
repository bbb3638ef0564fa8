# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What a run costs: as a process of its own, and scan by scan."""

import os
import subprocess
import sys
import time
from collections import Counter, defaultdict
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from msss_graphslam.cli.exit_codes import ExitCode
from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.pipeline import Pipeline
from msss_graphslam.core.recipes import ESTIMATORS
from msss_graphslam.core.types import Array, ConstraintKind
from msss_graphslam.recordings.reader import Recording
from msss_graphslam.results.directory import ResultDirectory

__all__ = ["ProcessCost", "ScanCosts", "process_cost", "scan_costs"]

FIRST_STAGE = "scan_generation"
STAGES = (
    FIRST_STAGE,
    "data_association",
    "scan_matching",
    "back_end",
    "trajectory_correction",
)
"""The work on a finished turn; what is done beam by beam, or after the last turn, is not in it."""


@dataclass(frozen=True, slots=True)
class ProcessCost:
    """What a process took.

    ``estimation`` is the CPU time [s] from the bag to the estimate and its maps, ``cpu`` that of
    all, imports, files and report included; ``peak_mib`` the peak resident memory [MiB].
    """

    estimation: float
    cpu: float
    peak_mib: float


@dataclass(frozen=True, slots=True)
class ScanCosts:
    """CPU time and loop closures of n scans.

    ``stages`` holds for each of STAGES its times (n,) [s]; ``tried`` (n,) counts the loop closures
    that were tried with earlier scans.
    """

    stages: dict[str, Array]
    tried: Array

    @property
    def total(self) -> Array:
        """The time (n,) [s] of all stages."""
        return np.asarray(np.sum(list(self.stages.values()), axis=0))

    def last(self, count: int) -> "ScanCosts":
        """Return those of the last scans."""
        stages = {name: times[-count:] for name, times in self.stages.items()}
        return ScanCosts(stages, self.tried[-count:])


def process_cost(bag: Path, estimator: str, output: Path) -> ProcessCost:
    """Run ``msss run``, with its progress, as a process; CalledProcessError where it fails."""
    command = [sys.executable, "-m", "msss_graphslam", "run", str(bag)]
    command += ["--out", str(output), "--estimator", estimator]
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL)  # noqa: S603
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode not in (ExitCode.CLEAN, ExitCode.DATA_LOST):
        raise subprocess.CalledProcessError(process.returncode, command)
    return ProcessCost(
        estimation=ResultDirectory(output).read_summary()["cpu_s"],
        cpu=usage.ru_utime + usage.ru_stime,
        peak_mib=usage.ru_maxrss / 1024.0,
    )


def scan_costs(
    recording: Recording, estimator: str, start: float = 0.0, end: float = 1.0
) -> ScanCosts:
    """Run an estimator over a part of the recording and measure the work on each of its scans.

    ``start`` and ``end`` are shares of the recording's duration.
    """
    duration = recording.end_ns - recording.start_ns
    first, last = (recording.start_ns + int(share * duration) for share in (start, end))
    watch = _ScanWatch()
    pipeline = Pipeline(Configuration(), ESTIMATORS[estimator], Counter(), watch.stage)
    for measurement in recording.measurements(Counter(), Configuration()):
        if first <= measurement.stamp_ns <= last:
            pipeline.process(measurement)
    constraints = pipeline.finish().constraints
    loops = [edge.second for edge in constraints if edge.kind is ConstraintKind.LOOP]
    keyframes = [scan for scan in watch.scans if "back_end" in scan]
    return ScanCosts(
        stages={name: np.array([scan[name] for scan in keyframes]) for name in STAGES},
        tried=np.bincount(loops, minlength=len(keyframes)).astype(float),
    )


class _ScanWatch:
    """CPU time of every stage, scan by scan; a scan's work begins with its generation."""

    def __init__(self) -> None:
        self.scans: list[defaultdict[str, float]] = []

    @contextmanager
    def stage(self, name: str) -> Iterator[None]:
        """Time one call of the named stage."""
        if name == FIRST_STAGE:
            self.scans.append(defaultdict(float))
        start = time.process_time()
        yield
        if self.scans:
            self.scans[-1][name] += time.process_time() - start
