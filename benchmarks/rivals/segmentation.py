# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Our segmentation beside a fixed threshold: which walls are found, what is made up."""

import time
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from benchmarks.tables import Table
from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.echoes.beam_segmentation import BeamSegmenter
from msss_graphslam.core.echoes.echo_extraction import to_decibels
from msss_graphslam.core.scans.scan_generator import BLOCK
from msss_graphslam.core.types import Array, Beam, Scan, Trajectory
from msss_graphslam.evaluation.errors import interpolate
from msss_graphslam.recordings.reader import Recording
from msss_graphslam.simulation.worlds import World

__all__ = ["Detection", "detection", "detections", "segmentation_table"]

THRESHOLDS = (20.0, 25.0, 30.0, 35.0, 40.0)
"""Levels [dB] of the fixed threshold; 0..255 of a code are 0..80 dB."""

BLANKING = 1.6
"""Range of the hull's ringing [m], which a fixed threshold must not look at."""

NEAR = 0.25
"""A point this near the wall that the beam meets is right [m]."""


@dataclass(frozen=True, slots=True)
class Detection:
    """What was made of the beams.

    ``found`` is the share of beams that meet a wall and have a point on it, ``ghosts`` the share
    of points that are on none; ``seconds`` CPU time a beam, None where it was not measured.
    """

    name: str
    found: float
    ghosts: float
    error: float
    seconds: float | None


def detections(
    recording: Recording, scans: Sequence[Scan], truth: Trajectory, world: World
) -> Iterator[Detection]:
    """Yield ours and the fixed thresholds on all beams of the scans."""
    configuration = recording.completed(Configuration())
    beams = {
        beam.stamp_ns: beam
        for beam in recording.measurements(Counter(), configuration)
        if isinstance(beam, Beam)
    }
    used = [beams[int(stamp)] for scan in scans for stamp in scan.beam_stamps_ns]
    walls = _walls(used, truth, world)
    yield _ours(scans, used, walls, configuration)
    levels = to_decibels(np.array([beam.intensities for beam in used]), "db80")
    ranges = used[0].ranges
    levels[:, ranges < BLANKING] = 0.0
    for threshold in THRESHOLDS:
        yield _fixed(levels, ranges, walls, threshold)
    strongest = ranges[levels.argmax(axis=1)]
    yield detection("strongest bin", np.arange(len(used)), strongest, walls, None)


def _walls(beams: Sequence[Beam], truth: Trajectory, world: World) -> Array:
    """Return how far each beam's axis goes to the first wall (b,) [m]; inf beyond its range."""
    poses, _ = interpolate(truth, np.array([beam.stamp_ns for beam in beams]))
    bearings = np.array([beam.bearing for beam in beams])
    ranges = world.walls.cast(poses[:, :2], poses[:, 2] + bearings).ranges
    return np.where(ranges < beams[0].ranges[-1], ranges, np.inf)


def _ours(
    scans: Iterable[Scan], beams: Sequence[Beam], walls: Array, configuration: Configuration
) -> Detection:
    segmenter = BeamSegmenter(configuration.sonar, configuration.segmentation)
    clock = time.process_time()
    for first in range(0, len(beams), BLOCK):
        segmenter.segment_all(beams[first : first + BLOCK])
    seconds = (time.process_time() - clock) / len(beams)
    numbers, ranges, first = [], [], 0
    for scan in scans:
        numbers.append(first + scan.beam_index)
        ranges.append(np.hypot(*scan.body_points.T))
        first += len(scan.beam_stamps_ns)
    return detection("ours", np.concatenate(numbers), np.concatenate(ranges), walls, seconds)


def _fixed(levels: Array, ranges: Array, walls: Array, threshold: float) -> Detection:
    clock = time.process_time()
    above = levels > threshold
    hit = np.flatnonzero(above.any(axis=1))
    found = ranges[above.argmax(axis=1)[hit]]
    seconds = (time.process_time() - clock) / len(levels)
    return detection(f"first bin above {threshold:.0f} dB", hit, found, walls, seconds)


def detection(
    name: str, numbers: NDArray[np.intp], ranges: Array, walls: Array, seconds: float | None
) -> Detection:
    """Judge points in beams ``numbers`` (n,) at ``ranges`` (n,) by the ``walls`` (b,) [m]."""
    errors = np.abs(ranges - walls[numbers])
    right = errors < NEAR
    met = np.isfinite(walls)
    found = len(np.unique(numbers[right])) / int(met.sum())
    error = float(np.median(errors[right])) if right.any() else np.nan
    return Detection(name, found, 1.0 - float(right.mean()), error, seconds)


def segmentation_table(world: str, found: Iterable[Detection]) -> Table:
    """Return a row a way of finding walls."""
    rows = [
        [
            row.name,
            f"{100.0 * row.found:.1f}",
            f"{100.0 * row.ghosts:.1f}",
            f"{100.0 * row.error:.1f}",
            "" if row.seconds is None else f"{1e6 * row.seconds:.1f}",
        ]
        for row in found
    ]
    header = [
        "way",
        "walls found [%]",
        f"points off any wall by {NEAR:g} m [%]",
        "median error [cm]",
        "µs per beam",
    ]
    return Table(f"segmentation, {world}", header, rows)
