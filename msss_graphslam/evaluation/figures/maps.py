# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Maps: points by estimator side by side (the paper's Figure 12), and the occupancy grid."""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.colors import ListedColormap

from msss_graphslam.core.compounding import transform_points
from msss_graphslam.core.types import Array
from msss_graphslam.evaluation.assessment import DEAD_RECKONING, Assessment
from msss_graphslam.evaluation.figures.panels import map_extent, map_figure
from msss_graphslam.evaluation.figures.style import Plate, colour, label
from msss_graphslam.evaluation.figures.trajectories import draw_ends, draw_points, draw_track
from msss_graphslam.evaluation.map_consistency import seen_again

__all__ = ["maps", "occupancy"]

_UNSEEN = (0.80, 0.87, 0.94)


def maps(assessments: Sequence[Assessment]) -> Plate:
    """Draw the same echoes as each estimator places them, with its trajectory."""
    placed = _placed(assessments)
    clouds = {name: np.vstack([np.zeros((0, 2)), *scans]) for name, scans in placed.items()}
    tracks = {name: path for run in assessments for name, path in run.trajectories.items()}
    positions = np.vstack([path.planar[:, :2] for path in tracks.values()])
    extent = map_extent(np.vstack(list(clouds.values())), positions)
    figure, panels = map_figure(extent, len(clouds))
    for axes, (name, points) in zip(panels, clouds.items(), strict=True):
        draw_points(axes, points)
        draw_track(axes, tracks[name].planar, colour(name), label(name))
        draw_ends(axes, tracks[name].planar, colour(name))
        axes.set_title(label(name), color=colour(name))
    return Plate("maps", "The map by estimator", _caption(assessments, placed), figure)


def occupancy(assessment: Assessment) -> Plate | None:
    """Draw the occupancy grid and the trajectory; None where nothing was seen."""
    grid = assessment.record.grid
    if not grid.occupancy.size:
        return None
    (west, south), (rows, columns) = grid.origin, grid.occupancy.shape
    east, north = west + columns * grid.resolution, south + rows * grid.resolution
    track = assessment.record.estimate.trajectory.planar
    extent = map_extent(assessment.record.points, track[:, :2])
    figure, (axes,) = map_figure(extent)
    axes.grid(visible=False)
    axes.set_facecolor(_UNSEEN)
    axes.imshow(
        grid.occupancy,
        cmap=_occupancy_colours(),
        vmin=-1,
        vmax=100,
        origin="lower",
        extent=(west, east, south, north),
        interpolation="nearest",
    )
    shade = colour(assessment.estimator)
    axes.set(xlim=extent[:, 0], ylim=extent[:, 1])
    draw_track(axes, track, shade, "trajectory")
    caption = (
        f"Cells of {grid.resolution:g} m: white is water that beams passed through, the darker the"
        " more probably a wall, pale blue was never seen."
    )
    return Plate("occupancy", "Occupancy grid", caption, figure)


def _placed(assessments: Sequence[Assessment]) -> dict[str, list[Array]]:
    """Return the points (n, 2) [m] of each scan as each estimator places them."""
    poses = {
        run.estimator: [(frame.pose, frame.scan) for frame in run.record.estimate.keyframes]
        for run in assessments
    }
    reckoned = [(scan.odometry, scan) for scan in assessments[-1].record.estimate.first_scans]
    return {
        name: [transform_points(pose, scan.points) for pose, scan in scans]
        for name, scans in ({DEAD_RECKONING: reckoned} | poses).items()
    }


def _occupancy_colours() -> ListedColormap:
    """Return pale blue for -1, then white to dark for 0 to 100 per cent."""
    dark = np.array([0.10, 0.16, 0.24])
    shares = np.linspace(0.0, 1.0, 101)[:, None]
    return ListedColormap(np.vstack([[_UNSEEN], 1.0 - shares * (1.0 - dark)]))


def _caption(assessments: Sequence[Assessment], placed: Mapping[str, list[Array]]) -> str:
    thickness = {run.estimator: run.thickness for run in assessments}
    thickness = {DEAD_RECKONING: assessments[-1].dead_reckoned_thickness} | thickness
    known = ", ".join(
        f"{label(name)} {100 * value:.1f} cm"
        for name, value in thickness.items()
        if value is not None
    )
    sharpness = (
        f" Thickness of the walls (median standard deviation across): {known}." if known else ""
    )
    return (
        "The same echoes, placed by each estimator's poses. Walls seen from several places fall"
        f" on one another where the poses are right.{sharpness}{_agreement(placed)}"
    )


def _agreement(placed: Mapping[str, list[Array]]) -> str:
    """Say how many points lie where another scan has one, by estimator."""
    shares = {name: seen_again(scans) for name, scans in placed.items()}
    known = ", ".join(
        f"{label(name)} {100 * share:.0f} %" for name, share in shares.items() if share is not None
    )
    return f" Points within 0.25 m of another scan's: {known}." if known else ""
