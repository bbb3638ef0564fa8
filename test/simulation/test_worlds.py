# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest

from msss_graphslam.core.types import Array
from msss_graphslam.errors import UserError
from msss_graphslam.simulation.path import Path
from msss_graphslam.simulation.vehicle import Motion, drive
from msss_graphslam.simulation.worlds import WORLD_NAMES, World, world_named


def drive_through(world: World, seed: int = 1, scale: float = 1.0) -> Motion:
    return drive(world.path, world.laps, world.depth, seed, scale)


def distance_to_walls(world: World, points: Array) -> Array:
    """The distance of points to the nearest wall, by projection on every edge."""
    walls = world.walls
    lengths = np.sum(walls.edges**2, axis=1)
    share = np.sum((points[:, None] - walls.starts) * walls.edges, axis=2) / lengths
    feet = walls.starts + np.clip(share, 0.0, 1.0)[..., None] * walls.edges
    return np.min(np.linalg.norm(points[:, None] - feet, axis=2), axis=1)


@pytest.mark.parametrize("name", WORLD_NAMES)
def test_the_vehicle_stays_clear_of_the_walls(name: str) -> None:
    world = world_named(name)
    for seed in range(3):
        points = drive_through(world, seed, scale=2.0).poses[::50, :2]
        assert distance_to_walls(world, points).min() > 1.0


@pytest.mark.parametrize("name", WORLD_NAMES)
def test_the_outer_wall_is_closed_around_the_path(name: str) -> None:
    world = world_named(name)
    points = world.path.points[::200]
    around = np.linspace(-np.pi, np.pi, 36)
    assert np.isfinite(world.walls.cast(points[:, None], around).ranges).all()


@pytest.mark.parametrize("name", WORLD_NAMES)
def test_walls_are_in_view_all_the_way(name: str) -> None:
    world = world_named(name)
    points = world.path.points[::100]
    around = np.linspace(-np.pi, np.pi, 72, endpoint=False)
    seen = world.walls.cast(points[:, None], around).ranges < world.sonar.maximum_range
    assert seen.mean(axis=1).min() > 0.35


@pytest.mark.parametrize(("name", "metres"), [("paper", 166), ("marina", 600), ("cave", 195)])
def test_the_true_path_has_the_stated_length(name: str, metres: float) -> None:
    world = world_named(name)
    for seed in range(3):
        steps = np.diff(drive_through(world, seed).poses[:, :2], axis=0)
        assert np.linalg.norm(steps, axis=1).sum() == pytest.approx(metres, abs=2.0)


@pytest.mark.parametrize("name", WORLD_NAMES)
def test_the_mission_begins_at_the_origin_and_ends_there(name: str) -> None:
    planar = drive_through(world_named(name)).poses[:, :2]
    np.testing.assert_allclose(planar[0], 0.0, atol=1e-6)
    assert np.linalg.norm(planar[-1] - planar[0]) < 0.05


def test_the_pond_is_the_papers() -> None:
    world = world_named("pond")
    np.testing.assert_allclose(np.ptp(world.outlines[0], axis=0), [33.0, 13.0])
    sonar = world.sonar
    assert (sonar.maximum_range, sonar.bins) == (20.0, 350)
    assert np.degrees(sonar.step) == pytest.approx(1.8)


def test_the_papers_sonar_turns_in_twelve_seconds_with_240_beams() -> None:
    sonar = world_named("paper").sonar
    assert 2.0 * np.pi / sonar.step == pytest.approx(240.0)
    assert 240 * sonar.beam_period == pytest.approx(12.0)


def test_an_unknown_world_is_refused_with_the_known_ones() -> None:
    with pytest.raises(UserError, match=r"no world 'ocean'.*paper, pond, marina, cave"):
        world_named("ocean")


def test_a_circular_path_has_the_length_and_normals_of_a_circle() -> None:
    angles = np.linspace(0.0, 2.0 * np.pi, 60, endpoint=False)
    path = Path.through(5.0 * np.stack([np.cos(angles), np.sin(angles)], axis=1))
    assert path.lap_length == pytest.approx(10.0 * np.pi, rel=1e-4)
    positions, normals = path.at(np.array([0.0, 3.0, path.lap_length + 3.0]))
    np.testing.assert_allclose(normals, -positions / 5.0, atol=1e-3)
    np.testing.assert_allclose(positions[1], positions[2], atol=1e-9)
