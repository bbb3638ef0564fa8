# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The worlds: their walls, the path through them and the sonar's settings there."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from msss_graphslam.core.types import Array
from msss_graphslam.errors import UserError
from msss_graphslam.simulation.path import Path
from msss_graphslam.simulation.processes import GaussMarkov
from msss_graphslam.simulation.ray_casting import Walls
from msss_graphslam.simulation.settings import Rotation, SonarSettings
from msss_graphslam.simulation.streams import stream

__all__ = ["WORLD_NAMES", "World", "world_named"]


@dataclass(frozen=True, slots=True)
class World:
    """A basin seen from above; the path begins at the origin of ``map``.

    ``outlines`` are closed polygons (k, 2) [m]; ``rough`` walls (rock) spread an echo, smooth
    ones (concrete) do not. ``depth`` [m] is the vehicle's.
    """

    name: str
    outlines: tuple[Array, ...]
    path: Path
    laps: int
    depth: float
    rough: bool
    sonar: SonarSettings

    @property
    def walls(self) -> Walls:
        """The walls that rays meet."""
        return Walls.of(self.outlines)


def world_named(name: str) -> World:
    """Return the world of that name; raises UserError where there is none."""
    if name not in _WORLDS:
        raise UserError(f"no world {name!r}: choose one of {', '.join(_WORLDS)}")
    return _WORLDS[name]()


def _paper() -> World:
    """Make a basin like Figure 8: irregular, with an island; two rounds of together 166 m."""
    basin = _points(
        "-18 -15, -6 -17.5, 5 -15.5, 13 -18, 22 -12, 20.5 -3, 24 4, 21 13,"
        "12 15, 9 18.5, -2 16, -9 19, -19 14, -22 5, -19.5 -3"
    )
    island = _points(
        "-8 -4.5, -3 -6, 1 -4, 7.5 -5.5, 9.5 0, 6 2.5, 7 6, 0.5 7, -2 4.5, -7.5 5.5, -9.5 1"
    )
    waypoints = _points(
        "0 -10.5, 9 -10.8, 14.6 -5, 14.5 3, 12 10, 3 11.8, -7 11.6, -14 7.5, -14.6 -1, -11.5 -8.8"
    )
    return _world(
        "paper",
        [_rock(basin, "basin", 0.2), _rock(island, "island", 0.2)],
        _lap(waypoints, 83.0),
        rough=True,
        sonar=SonarSettings(24.0, 400, np.radians(1.5), 0.05),
    )


def _pond() -> World:
    """Make the 33 m x 13 m pond of Section VIII-B, with the Micron's settings there."""
    pond = _points(
        "0 0, 12 0, 12 1.2, 14.5 1.2, 14.5 0, 33 0, 33 9.5, 31.5 9.5, 31.5 13, 6 13,"
        "4.5 12.2, 0 12.2"
    )
    waypoints = _points(
        "5 4.2, 11 3.9, 18 3.6, 25 3.5, 28.6 6, 25.5 9.2, 18 9.4, 10 9.1, 5 8.6, 3.2 6.4"
    )
    return _world(
        "pond",
        [pond],
        _lap(waypoints, 58.0),
        rough=False,
        sonar=SonarSettings(20.0, 350, np.radians(1.8), 0.0427, Rotation.CLOCKWISE),
    )


def _marina() -> World:
    """Make a harbour with quays and piers; two rounds of together 600 m at 50 m range."""
    harbour = _points(
        "0 0, 55 -3, 55 14, 59 14, 59 -3, 118 2, 121 30, 110 31, 110 35, 121 34, 126 78, 82 84,"
        "81 66, 77 66, 77 84.5, 30 88, 2 80, -4 46, 5 45, 5 41, -4 42"
    )
    breakwater = _points("38 36, 66 33, 86 42, 84 49, 64 45, 41 50")
    waypoints = _points(
        "16 22, 34 20, 56 21.5, 80 19, 98 21, 97 40, 106 58, 95 66, 80 58, 62 62, 40 69,"
        "22 66, 17 44"
    )
    return _world(
        "marina",
        [harbour, _rock(breakwater, "breakwater", 0.25)],
        _lap(waypoints, 300.0),
        rough=False,
        sonar=SonarSettings(50.0, 500, np.radians(1.8), 0.078),
    )


def _cave() -> World:
    """Make a winding cave with chambers and pillars; in on one side of it, out on the other."""
    cave = _points(
        "-8 -9.7, 4 -5, 14 1.2, 22 -2.6, 34 -9.6, 44 -9.8, 52 -12, 60 -3.2, 70 3.6, 80 3.9,"
        "91 8.4, 94 18.4, 86 27, 75 21.6, 67 20.7, 56 11.5, 47 4.2, 38 7.2, 31 7.7, 23 12.6,"
        "13 15.5, 3 9.9, -7 4.3, -10 -3.5"
    )
    rock = _points("33.5 -1.5, 35.6 -2.8, 36 -0.9, 34.2 0.4")
    pillar = _points("77.4 12.8, 80.4 13.4, 80.6 16, 78 15.6")
    waypoints = _points(
        "0 -2.5, 8 1.9, 18 3.6, 28 -1.8, 38 -6.8, 48 -6.6, 58 1.1, 70 8.6, 80 8.5, 88.5 13.9,"
        "84.5 21.4, 74 16, 64 11.9, 54 4.1, 44 -0.8, 36 3.8, 28 4.9, 18 9, 8 8.1, 0 3"
    )
    return _world(
        "cave",
        [_rock(cave, "cave", 0.25), _rock(rock, "rock", 0.25), _rock(pillar, "pillar", 0.25)],
        _lap(waypoints, 195.0),
        rough=True,
        laps=1,
        sonar=SonarSettings(20.0, 400, np.radians(1.8), 0.0427),
    )


_WORLDS: dict[str, Callable[[], World]] = {
    "paper": _paper,
    "pond": _pond,
    "marina": _marina,
    "cave": _cave,
}
WORLD_NAMES = tuple(_WORLDS)

_ROCK_SPACING = 0.5
_RELIEF = GaussMarkov(1.0, 2.0)


def _world(
    name: str,
    outlines: list[Array],
    waypoints: Array,
    *,
    rough: bool,
    sonar: SonarSettings,
    laps: int = 2,
) -> World:
    start = waypoints[0]
    placed = tuple(outline - start for outline in outlines)
    return World(name, placed, Path.through(waypoints - start), laps, 2.0, rough, sonar)


def _points(text: str) -> Array:
    """Return points (k, 2) [m] from ``x y, x y, ...``."""
    return np.array(text.replace(",", " ").split(), dtype=float).reshape(-1, 2)


def _lap(waypoints: Array, length: float) -> Array:
    """Return the waypoints, scaled about their centre so that the lap is ``length`` [m] long."""
    centre = np.mean(waypoints, axis=0)
    scale = length / Path.through(waypoints).lap_length
    return np.asarray(centre + scale * (waypoints - centre))


def _rock(corners: Array, name: str, deviation: float) -> Array:
    """Return the outline in short faces that stand ``deviation`` [m] before and behind it."""
    closed = np.vstack([corners, corners[:1]])
    sides = np.diff(closed, axis=0)
    lengths = np.linalg.norm(sides, axis=1)
    corners_at = np.concatenate([[0.0], np.cumsum(lengths)])
    count = int(corners_at[-1] / _ROCK_SPACING)
    at = np.linspace(0.0, corners_at[-1], count, endpoint=False)
    outline = np.stack([np.interp(at, corners_at, column) for column in closed.T], axis=1)
    tangents = (sides / lengths[:, None])[np.searchsorted(corners_at, at, side="right") - 1]
    relief = _RELIEF.sample(stream(0, f"relief of the {name}"), count, _ROCK_SPACING)
    relief *= deviation
    return np.asarray(outline + np.stack([-tangents[:, 1], tangents[:, 0]], 1) * relief[:, None])
