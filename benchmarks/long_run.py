# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""One long mission through the offline pipeline, in a process of its own, scan by scan."""

import os
import resource
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any
from unittest.mock import patch

import numpy as np

from benchmarks.long_simulation import LAUNCH_NS
from msss_graphslam.config.configuration import Configuration
from msss_graphslam.config.groups import Segmentation, Sonar
from msss_graphslam.core.echoes.beam_segmentation import BeamSegmenter
from msss_graphslam.core.pipeline import Pipeline
from msss_graphslam.core.recipes import ESTIMATORS
from msss_graphslam.core.scans import scan_generator
from msss_graphslam.core.types import (
    Array,
    Beam,
    ConstraintKind,
    Depth,
    Estimate,
    Inertial,
    Measurement,
    Reading,
    Trajectory,
)
from msss_graphslam.evaluation.errors import position_errors
from msss_graphslam.offline.freed_memory import give_back

__all__ = ["FirstRange", "measure", "measurements"]

MIB = 2.0**20
WATER = 9806.65
SURFACE = 101_325.0
LEVEL = 45.0
VARIANCE = 0.04**2


class FirstRange:
    """Stands in for segmentation where a beam brings the range that it would leave."""

    def __init__(self, sonar: Sonar, config: Segmentation) -> None:
        del sonar, config

    def segment(self, beam: Beam) -> Reading:
        """Return the reading of a beam whose ``ranges`` are its echoes."""
        count = len(beam.ranges)
        return Reading(
            stamp_ns=beam.stamp_ns,
            bearing=beam.bearing,
            ranges=beam.ranges,
            variances=np.full(count, VARIANCE),
            levels=np.full(count, LEVEL),
            maximum_range=float(beam.intensities[0]),
        )

    def segment_all(self, beams: Sequence[Beam]) -> list[Reading]:
        """Return the readings of the beams."""
        return [self.segment(beam) for beam in beams]


def measurements(file: Path, bin_ranges: Array) -> Iterator[Measurement]:
    """Return what one file of a simulation holds, in the order of its stamps.

    ``bin_ranges`` (bins,) [m] are those of beams with echoes.
    """
    with np.load(file) as columns:
        data = dict(columns)
    last = bin_ranges[-1:]
    stamped: list[Measurement] = []
    for stamp, orientation, rates in _rows(data, "inertial", 3):
        stamped.append(Inertial(stamp, orientation, rates))
    for stamp, pressure in _rows(data, "pressure", 2):
        stamped.append(Depth(stamp, (SURFACE - float(pressure)) / WATER))
    for stamp, bearing, measured, _ in _rows(data, "beam", 4):
        if measured.ndim:
            stamped.append(Beam(stamp, float(bearing), bin_ranges, measured))
        else:
            ranges = np.atleast_1d(measured)
            stamped.append(Beam(stamp, float(bearing), ranges[np.isfinite(ranges)], last))
    return iter(sorted(stamped, key=lambda entry: entry.stamp_ns))


def measure(folder: Path, bin_ranges: Array, estimator: str) -> dict[str, Array]:
    """Run the estimator over a simulation; return all figures of it by name.

    By scan (n,): ``seconds`` of CPU, resident memory ``mib``, accepted ``edges``, ``loops``. At
    the end: seconds ``finish_s``, peak memories ``peak_mib`` before it and after it. By beam:
    ``online_m`` and ``final_m``, anchored errors, and ``aligned_m`` after the best fit.
    """
    files = sorted(folder.glob("*.npz"))
    watch = _Watch()
    with np.load(files[0]) as first:
        has_echoes = first["beam_2"].ndim > 1
    segmenter = BeamSegmenter if has_echoes else FirstRange
    with patch.object(scan_generator, "BeamSegmenter", segmenter):
        pipeline = Pipeline(Configuration(), ESTIMATORS[estimator], Counter(), watch.stage)
    begun = time.process_time()
    for file in files:
        for measurement in measurements(file, bin_ranges):
            watch.time(pipeline, measurement)
    peaks, online_s = [_peak_mib()], time.process_time() - begun
    begun = time.process_time()
    estimate = pipeline.finish(lambda _: give_back())
    finish_s = time.process_time() - begun
    return {
        **watch.columns(),
        "finish_s": np.array(finish_s),
        "before_finish_s": np.array(online_s),
        "peak_mib": np.array([*peaks, _peak_mib()]),
        **_edges(estimate),
        **_errors(estimate, _truth(files)),
    }


class _Watch:
    """CPU time and memory of every call of the pipeline that makes a keyframe."""

    def __init__(self) -> None:
        self._seconds: list[float] = []
        self._mib: list[float] = []
        self._has_scan = False

    @contextmanager
    def stage(self, name: str) -> Iterator[None]:
        """Note that a scan is taken in."""
        self._has_scan |= name == "back_end"
        yield

    def time(self, pipeline: Pipeline, measurement: Measurement) -> None:
        """Let the pipeline take in a measurement."""
        begun = time.process_time()
        pipeline.process(measurement)
        if self._has_scan:
            self._seconds.append(time.process_time() - begun)
            self._mib.append(_resident_mib())
            self._has_scan = False

    def columns(self) -> dict[str, Array]:
        """Return what was noted."""
        return {"seconds": np.array(self._seconds), "mib": np.array(self._mib)}


def _rows(data: dict[str, Array], name: str, count: int) -> Iterator[tuple[Any, ...]]:
    times, *columns = (data[f"{name}_{place}"] for place in range(count))
    stamps = LAUNCH_NS + np.rint(times * 1e9).astype(np.int64)
    return zip(stamps.tolist(), *columns, strict=True)


def _truth(files: list[Path]) -> Trajectory:
    times, poses = [], []
    for file in files:
        with np.load(file) as columns:
            times.append(columns["beam_0"])
            poses.append(columns["beam_3"])
    stamps = LAUNCH_NS + np.rint(np.concatenate(times) * 1e9).astype(np.int64)
    return Trajectory(stamps, np.concatenate(poses))


def _edges(estimate: Estimate) -> dict[str, Array]:
    accepted = [edge for edge in estimate.constraints if edge.accepted]
    loops = [edge.second for edge in accepted if edge.kind is ConstraintKind.LOOP]
    count = len(estimate.keyframes)
    return {
        "edges": np.bincount([edge.second for edge in accepted], minlength=count),
        "loops": np.bincount(loops, minlength=count),
        "points": np.array([len(frame.scan.points) for frame in estimate.keyframes]),
    }


def _errors(estimate: Estimate, truth: Trajectory) -> dict[str, Array]:
    final, online = (
        position_errors(trajectory, truth, estimate.trajectory)
        for trajectory in (estimate.trajectory, estimate.online)
    )
    return {"online_m": online.anchored, "final_m": final.anchored, "aligned_m": final.aligned}


def _resident_mib() -> float:
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / MIB


def _peak_mib() -> float:
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0
