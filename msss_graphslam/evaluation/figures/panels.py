# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Where the panels of a figure lie.

Their places are reckoned with room for labels and legends, as the margin that is left blank is cut
off in the end. Matplotlib's own layouts find them by laying out all text twice, which takes as
long as the drawing.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from msss_graphslam.core.types import Array

__all__ = ["map_extent", "map_figure", "panels", "room_for", "square_panels"]

_WIDTH = 9.4
_MOST_COLUMNS = 3
_HIGHEST = 7.5
_FLAT = 0.6
_STRAYS = 0.003

# Room [inch] for what stands beside the panels and between them.
_LEFT, _RIGHT, _BELOW, _ABOVE = 0.85, 0.3, 0.7, 1.7
_LEGEND = 4.5
_BESIDE, _BENEATH = 0.3, 0.15
_LETTER = 0.075


def panels(
    rows: int,
    columns: int,
    height: float,
    *,
    left: float = _LEFT,
    between: tuple[float, float] = (_BESIDE, _BENEATH),
    width: float | None = None,
    **subplots: Any,
) -> tuple[Figure, Any]:
    """Return a figure and its panels (rows, columns), which are so high together [inch].

    ``left`` is the room on the left, ``between`` that from panel to panel, to the right and
    downwards, ``width`` that of the panels with what is between, all of the page if None [inch].
    """
    width = _WIDTH - left - _RIGHT if width is None else width
    last = (width - between[0] * (columns - 1)) / columns
    page = max(_WIDTH, left + width - last + max(last + _RIGHT, _LEGEND))
    sheet = _BELOW + height + _ABOVE
    figure = Figure(figsize=(page, sheet))
    placed = {
        "left": left / page,
        "right": (left + width) / page,
        "bottom": _BELOW / sheet,
        "top": (_BELOW + height) / sheet,
        "wspace": between[0] * columns / (width - between[0] * (columns - 1)),
        "hspace": between[1] * rows / (height - between[1] * (rows - 1)),
    }
    grid = figure.subplots(rows, columns, squeeze=False, gridspec_kw=placed, **subplots)
    return figure, grid


def room_for(names: Sequence[str]) -> float:
    """Return the room [inch] for names on the left of a panel."""
    return 0.25 + _LETTER * max(map(len, names), default=0)


def square_panels(count: int) -> tuple[Figure, Sequence[Axes]]:
    """Return a figure of so many square panels side by side, which share their axes."""
    width = _WIDTH - _LEFT - _RIGHT
    edge = (width - _BESIDE * (count - 1)) / count
    figure, grid = panels(1, count, edge, sharex=True, sharey=True)
    return figure, list(grid[0])


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


def map_figure(
    corners: Array, count: int = 1, header: float = 0.35
) -> tuple[Figure, Sequence[Axes]]:
    """Return a figure for some maps that show the extent with these corners (2, 2) [m].

    ``header`` is the room [inch] for what stands over each.
    """
    across, along = corners[1] - corners[0]
    aspect = float(np.clip(along / across, 0.15, 1.5))
    columns = _columns(count, aspect)
    rows = -(-count // columns)
    whole = _WIDTH - _LEFT - _RIGHT - _BESIDE * (columns - 1)
    height = min(whole / columns * aspect, _HIGHEST)
    figure, grid = panels(
        rows,
        columns,
        rows * height + (rows - 1) * header,
        between=(_BESIDE, header),
        width=columns * height / aspect + _BESIDE * (columns - 1),
        sharex=True,
        sharey=True,
    )
    for axes in grid.flat:
        axes.set_aspect("equal", anchor="W")
        axes.set_xlim(*corners[:, 0])
        axes.set_ylim(*corners[:, 1])
    for axes in grid[-1]:
        axes.set_xlabel("x, east [m]")
    for axes in grid[:, 0]:
        axes.set_ylabel("y, north [m]")
    for axes in grid.flat[count:]:
        axes.set_visible(False)
    return figure, list(grid.flat[:count])


def _columns(count: int, aspect: float) -> int:
    """Return how many maps fit side by side: two flat ones are legible only one a row."""
    if count == 2 and aspect < _FLAT:
        return 1
    return count if count <= _MOST_COLUMNS else 2
