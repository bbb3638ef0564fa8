# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""How every figure looks."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from msss_graphslam.core.types import Array
from msss_graphslam.evaluation.wording import ACCENT, colour, label, phrase

__all__ = [
    "ACCENT",
    "MAP",
    "MUTED",
    "RC",
    "REFUSALS",
    "TRUTH",
    "Plate",
    "colour",
    "label",
    "map_extent",
    "map_figure",
    "minutes",
    "phrase",
]

TRUTH, MAP, MUTED = "#111111", "#76838f", "#5b6672"
REFUSALS = ("#d55e00", "#cc79a7", "#e69f00", "#56b4e9", "#009e73")
RC: dict[Any, Any] = {
    "figure.dpi": 150,
    "font.family": "DejaVu Sans",
    "font.size": 9.0,
    "axes.titlesize": 10.0,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.labelcolor": "#333a42",
    "axes.edgecolor": "#b5bdc6",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": "#e4e8ec",
    "grid.linewidth": 0.7,
    "xtick.color": MUTED,
    "ytick.color": MUTED,
    "legend.frameon": False,
    "legend.fontsize": 8.5,
    "legend.title_fontsize": 10.0,
    "lines.solid_capstyle": "round",
}
_WIDTH = 9.0
_MOST_COLUMNS = 3
_HIGHEST = 7.5
_FLAT = 0.6
_STRAYS = 0.003


@dataclass(frozen=True, slots=True)
class Plate:
    """A drawn figure, its file's name, its title and a caption that a person understands."""

    name: str
    title: str
    caption: str
    figure: Figure


def minutes(stamps_ns: Array | np.ndarray, start_ns: int) -> Array:
    """Return the time since the start [min]."""
    return np.asarray((np.asarray(stamps_ns) - start_ns) / 60e9)


def map_extent(points: Array, positions: Array) -> Array:
    """Return the corners (2, 2) [m] of a map: all positions, and the points but for a few strays.

    Ghosts far behind the walls would otherwise make every map small.
    """
    low, high = positions.min(axis=0), positions.max(axis=0)
    if len(points):
        inner = np.quantile(points[:, :2], [_STRAYS, 1.0 - _STRAYS], axis=0)
        low, high = np.minimum(low, inner[0]), np.maximum(high, inner[1])
    margin = 0.03 * float((high - low).max()) + 0.5
    return np.array([low - margin, high + margin])


def map_figure(corners: Array, panels: int = 1) -> tuple[Figure, list[Axes]]:
    """Return a figure for some maps that show the extent with these corners (2, 2) [m]."""
    width, height = corners[1] - corners[0]
    aspect = float(np.clip(height / width, 0.15, 1.5))
    columns = _columns(panels, aspect)
    rows = -(-panels // columns)
    row = min((_WIDTH / columns - 0.4) * aspect, _HIGHEST) + 0.6
    figure = Figure(figsize=(_WIDTH, rows * row + 0.4), layout="compressed")
    grid = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
    for axes in grid.flat:
        axes.set_aspect("equal")
        axes.set_xlim(*corners[:, 0])
        axes.set_ylim(*corners[:, 1])
    for axes in grid[-1]:
        axes.set_xlabel("x, east [m]")
    for axes in grid[:, 0]:
        axes.set_ylabel("y, north [m]")
    for axes in grid.flat[panels:]:
        axes.set_visible(False)
    return figure, list(grid.flat[:panels])


def _columns(panels: int, aspect: float) -> int:
    """Return how many maps fit side by side: two flat ones are legible only one a row."""
    if panels == 2 and aspect < _FLAT:
        return 1
    return panels if panels <= _MOST_COLUMNS else 2
