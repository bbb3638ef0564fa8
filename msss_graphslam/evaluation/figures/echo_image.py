# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The sonar image of one turn, distorted and corrected: the paper's Figure 2."""

import numpy as np
from matplotlib.axes import Axes

from msss_graphslam.core.compounding import transform_points
from msss_graphslam.core.types import Array, Beam, Stamps
from msss_graphslam.evaluation.assessment import Assessment
from msss_graphslam.evaluation.figures.panels import square_panels
from msss_graphslam.evaluation.figures.style import Plate
from msss_graphslam.results.record import example_scan

__all__ = ["echo_image"]


def echo_image(assessment: Assessment) -> Plate | None:
    """Draw the echoes of the example scan as the head sent them; None where they were not kept."""
    record = assessment.record
    number = example_scan(record.estimate)
    if number is None:
        return None
    scan = record.estimate.keyframes[number].scan
    beams, rows = _beams_of(record.example_beams, scan.beam_stamps_ns)
    if len(beams) < 2:
        return None
    sonar = record.configuration["sonar"]
    mount = np.array([sonar["mount_x"], sonar["mount_y"], sonar["mount_yaw"]])
    figure, panels = square_panels(2)
    _draw(panels[0], beams, mount, np.zeros((len(beams), 3)), "as measured")
    _draw(panels[1], beams, mount, scan.motion[rows], "corrected")
    panels[0].set_ylabel("y, to port [m]")
    caption = (
        "The echo profiles of the same turn, brighter is stronger, drawn with the vehicle at rest"
        " and along its corrected motion."
    )
    return Plate("echoes", "The sonar image of one turn", caption, figure)


def _beams_of(beams: tuple[Beam, ...], stamps_ns: Stamps) -> tuple[list[Beam], list[int]]:
    """Return the beams of the scan that have as many bins as most, and their rows in it."""
    rows = {int(stamp): row for row, stamp in enumerate(stamps_ns)}
    of_scan = [beam for beam in beams if beam.stamp_ns in rows]
    bins = int(np.median([len(beam.ranges) for beam in of_scan])) if of_scan else 0
    kept = [beam for beam in of_scan if len(beam.ranges) == bins]
    return kept, [rows[beam.stamp_ns] for beam in kept]


def _draw(axes: Axes, beams: list[Beam], mount: Array, motion: Array, title: str) -> None:
    bearings = np.array([beam.bearing for beam in beams]) + mount[2]
    ranges = np.array([beam.ranges for beam in beams])
    rays = np.stack([np.cos(bearings), np.sin(bearings)], axis=-1)[:, None] * ranges[..., None]
    flat = (rays + mount[:2]).reshape(-1, 2)
    placed = transform_points(np.repeat(motion, ranges.shape[1], axis=0), flat)
    x, y = placed.T.reshape(2, *ranges.shape)
    axes.set(aspect="equal", facecolor="#0b1522", title=title, xlabel="x, forward [m]")
    axes.grid(visible=False)
    codes = np.array([beam.intensities for beam in beams])[:-1, :-1]
    axes.pcolormesh(x, y, codes, cmap="cividis", vmin=0.0)
