# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0

import numpy as np
import pytest
from echo_profiles import reading_of
from hypothesis import given
from hypothesis import strategies as st
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from msss_graphslam.config.groups import Segmentation
from msss_graphslam.core.echoes.ghost_rejection import _stays, reject_ghosts
from msss_graphslam.core.echoes.turn_surfaces import (
    TurnEchoes,
    _connected,
    beams_by_chance,
    surfaces_of,
)

CONFIG = Segmentation()
WIDTH = np.radians(3.0)
BEAMS = 200
BEARINGS = np.arange(BEAMS) * 2.0 * np.pi / BEAMS
AHEAD = np.cos(BEARINGS) > np.cos(np.radians(60.0))


def wall(distance=5.0, level=48.0):
    """A straight wall ahead: per beam its echoes, weaker with the incidence."""
    cosines = np.cos(BEARINGS)
    return [
        [(distance / cosine, level + 20.0 * np.log10(cosine))] if seen else []
        for cosine, seen in zip(cosines, AHEAD, strict=True)
    ]


def turn(*scenes):
    """Readings of one turn that sees all scenes, the nearest echo of a beam first."""
    return [
        reading_of(bearing, sorted(echo for scene in scenes for echo in scene[beam]))
        for beam, bearing in enumerate(BEARINGS)
    ]


def placed(beams, distance, level):
    """The same echo in some beams."""
    return [[(distance, level)] if beam in beams else [] for beam in range(BEAMS)]


def kept(readings, config=CONFIG):
    return [reading.ranges.tolist() for reading in reject_ghosts(readings, config, WIDTH)]


def test_a_wall_stays_whole():
    assert kept(turn(wall())) == [[r for r, _ in echoes] for echoes in wall()]


def test_the_ring_of_sidelobes_goes_and_the_wall_stays():
    ring = placed(np.flatnonzero(~AHEAD), 5.0, 48.0 - 30.0)
    assert kept(turn(wall(), ring)) == kept(turn(wall()))


def test_a_ring_before_an_oblique_wall_uncovers_the_wall():
    ring = placed(np.flatnonzero(AHEAD & (np.cos(BEARINGS) < 0.8)), 5.0, 20.0)
    assert kept(turn(wall(), ring)) == kept(turn(wall()))


def mirrored(scene, weaker):
    """The scene in the mirror of the hull: bearing b looks like 166 degrees - b."""
    image = (np.round(np.radians(166.0) / BEARINGS[1]) - np.arange(BEAMS)).astype(int) % BEAMS
    return [[(r, level - weaker) for r, level in scene[beam]] for beam in image]


@pytest.mark.parametrize(("weaker", "ghosts"), [(20.0, False), (10.0, True)])
def test_the_mirror_image_goes_if_it_is_weak_enough(weaker, ghosts):
    image = mirrored(wall(), weaker)
    found = kept(turn(wall(), image)) != kept(turn(wall()))
    assert found == ghosts


@pytest.mark.parametrize(("weaker", "stays"), [(15.5, True), (16.5, False)])
def test_the_contrast_decides_between_surface_and_ghost(weaker, stays):
    strong, weak = placed(range(10), 5.0, 48.0), placed(range(90, 100), 5.0, 48.0 - weaker)
    assert (kept(turn(strong, weak))[95] == [5.0]) == stays


@pytest.mark.parametrize(("distance", "stays"), [(5.45, False), (5.55, True)])
def test_the_comparison_is_with_echoes_at_the_same_range(distance, stays):
    strong, weak = placed(range(10), 5.0, 48.0), placed(range(90, 100), distance, 25.0)
    assert (kept(turn(strong, weak))[95] == [distance]) == stays


def test_a_wall_that_fades_into_a_corner_stays_beside_a_strong_one_at_its_range():
    # Four walls of a tank: the ends of the weak wall are 20 dB under the strong one.
    fading = [[] for _ in range(BEAMS)]
    for beam in range(60, 90):
        fading[beam] = [(5.0 + 0.02 * (beam - 60), 44.0 - 0.55 * (beam - 60))]
    strong = [[(5.0 + 0.02 * beam, 48.0)] if beam < 30 else [] for beam in range(BEAMS)]
    assert all(kept(turn(strong, fading))[60:90])


@pytest.mark.parametrize(("beams", "stays"), [(2, False), (3, True)])
def test_a_pole_is_in_several_beams_and_a_speck_is_not(beams, stays):
    pole = placed(range(50, 50 + beams), 4.0, 40.0)
    assert (kept(turn(wall(), pole))[50] == [4.0]) == stays


def test_a_speck_beside_a_wall_does_not_join_it():
    found = kept(turn(wall(), placed([5], 4.5, 45.0)))
    assert found == kept(turn(wall()))


def test_a_beam_may_be_missing_from_a_surface():
    pole = placed([50, 52, 53], 4.0, 40.0)
    assert kept(turn(pole))[50] == [4.0]
    assert not any(kept(turn(placed([50, 53, 56], 4.0, 40.0))))


@pytest.mark.parametrize(("jump", "stays"), [(0.3, True), (0.8, False)])
def test_a_surface_is_no_steeper_than_echoes_come_back_from(jump, stays):
    # 1.2 rad of incidence at 4 m and 1.8 degrees: 0.32 m a beam.
    scene = [[] for _ in range(BEAMS)]
    for number in range(6):
        scene[50 + number] = [(4.0 + jump * number, 40.0)]
    assert any(kept(turn(scene))) == stays


@pytest.mark.parametrize(("change", "stays"), [(5.5, True), (6.5, False)])
def test_a_surface_changes_its_level_slowly(change, stays):
    scene = [[] for _ in range(BEAMS)]
    for beam in range(50, 56):
        scene[beam] = [(4.0, 40.0 + change * (beam % 3))]
    assert any(kept(turn(scene))) == stays


def test_a_surface_across_the_turn_s_end_is_one():
    assert kept(turn(placed([198, 199, 0], 4.0, 40.0)))[0] == [4.0]


def test_the_ends_of_a_sector_do_not_touch():
    sector = turn(placed([0, 98, 99], 4.0, 40.0))[:100]
    assert not any(kept(sector))


def test_readings_are_not_changed_in_place():
    readings = turn(wall(), placed([120], 4.0, 40.0))
    before = [reading.ranges.copy() for reading in readings]
    reject_ghosts(readings, CONFIG, WIDTH)
    assert all(np.array_equal(a.ranges, b) for a, b in zip(readings, before, strict=True))


@pytest.mark.parametrize("count", [0, 1, 2])
def test_a_turn_of_hardly_any_beams_is_taken(count):
    assert len(reject_ghosts(turn(wall())[:count], CONFIG, WIDTH)) == count


def test_a_turn_without_echoes_stays_so():
    assert not any(kept(turn([[]] * BEAMS)))


@given(st.integers(1, BEAMS - 1))
def test_where_the_turn_begins_does_not_matter(shift):
    readings = turn(wall(), mirrored(wall(), 20.0), placed([7, 8], 3.0, 44.0))
    turned = readings[shift:] + readings[:shift]
    found = kept(readings)
    assert kept(turned) == found[shift:] + found[:shift]


@given(
    st.lists(
        st.lists(st.tuples(st.floats(0.1, 20.0), st.floats(0.0, 80.0)), max_size=3),
        min_size=1,
        max_size=30,
    ),
    st.floats(-np.pi, np.pi),
)
def test_what_is_left_was_there_before(scene, offset):
    readings = [reading_of(offset + 0.03 * beam, sorted(e)) for beam, e in enumerate(scene)]
    for before, after in zip(readings, reject_ghosts(readings, CONFIG, WIDTH), strict=True):
        assert after.bearing == before.bearing
        assert set(after.ranges.tolist()) <= set(before.ranges.tolist())
        assert after.ranges.size == after.levels.size == after.variances.size


@pytest.mark.parametrize("links", [0, 1, 20, 60, 400])
def test_surfaces_are_the_connected_components_of_the_links(links):
    """SciPy's are the oracle: two echoes are of one surface here exactly where they are there."""
    for seed in range(20):
        first, second = np.random.default_rng(seed).integers(0, 60, (2, links))
        graph = coo_array((np.ones(links), (first, second)), shape=(60, 60))
        wanted = connected_components(graph, directed=False)[1]
        found = _connected(60, first, second)
        np.testing.assert_array_equal(
            found[:, None] == found[None, :], wanted[:, None] == wanted[None, :]
        )


@pytest.mark.parametrize("seed", range(20))
def test_surfaces_are_judged_as_one_after_another(seed):
    generator = np.random.default_rng(seed)
    count = int(generator.integers(1, 80))
    surfaces = 7 * generator.integers(0, 1 + count // 3, count)
    beams = np.sort(generator.integers(0, 40, count))
    deficits = generator.uniform(0.0, 2.0 * CONFIG.ghost_contrast, count)
    fewest = float(generator.uniform(1.0, 5.0))
    expected = np.zeros(count, dtype=bool)
    for surface in set(surfaces.tolist()):
        members = surfaces == surface
        seen = len(set(beams[members].tolist())) >= fewest
        expected[members] = seen and np.median(deficits[members]) < CONFIG.ghost_contrast
    found = _stays(surfaces, beams, deficits, fewest, CONFIG.ghost_contrast)
    np.testing.assert_array_equal(found, expected)


def specks(seed, each, nearest=1.0, farthest=40.0):
    """Echoes anywhere, ``each`` a beam on the average."""
    rng = np.random.default_rng(seed)
    return [
        [
            (rng.uniform(nearest, farthest), rng.uniform(30.0, 40.0))
            for _ in range(rng.poisson(each))
        ]
        for _ in range(BEAMS)
    ]


def chance(readings, width=WIDTH):
    echoes = TurnEchoes.of(readings)
    return beams_by_chance(echoes, surfaces_of(echoes, CONFIG), CONFIG, width)


@pytest.mark.parametrize("each", [2.0, 3.0])
def test_of_specks_hardly_a_surface_is_made(each):
    width = BEARINGS[1]
    surfaces, plain = 0, 0
    for seed in range(30):
        echoes = TurnEchoes.of(turn(specks(seed, each)))
        numbers = surfaces_of(echoes, CONFIG)
        beams = np.bincount(numbers[numbers >= 0])
        plain += np.count_nonzero(beams >= 3)
        surfaces += np.count_nonzero(beams >= beams_by_chance(echoes, numbers, CONFIG, width))
    assert plain > 30 * 20
    assert surfaces < plain / 8


def test_the_more_specks_the_more_beams_a_surface_needs():
    few, many = (np.mean([chance(turn(specks(s, each))) for s in range(5)]) for each in (0.5, 3.0))
    assert many > few + 1.0


def test_farther_off_a_surface_needs_more_beams():
    """Neighbouring beams are farther apart there, and a surface may lie in between."""
    near, far = (
        np.mean([chance(turn(specks(seed, 2.0, at, at + 10.0))) for seed in range(5)])
        for at in (1.0, 30.0)
    )
    assert far > near + 1.0


def test_beams_that_hear_the_same_speck_are_one_look():
    readings = turn(specks(3, 2.0))
    narrow = chance(readings, BEARINGS[1])
    assert chance(readings, 0.5 * BEARINGS[1]) == pytest.approx(narrow)
    assert chance(readings, 3.0 * BEARINGS[1]) - 1.0 == pytest.approx(3.0 * (narrow - 1.0))


def test_a_wall_stays_among_specks():
    found = kept(turn(wall(), specks(5, 1.0, farthest=60.0)))
    for echoes, ranges in zip(wall(), found, strict=True):
        assert {distance for distance, _ in echoes} <= set(ranges)


@pytest.mark.parametrize("beams", [8, 16, 66, BEAMS])
def test_a_tank_stays_where_all_ranges_are_alike(beams):
    rng = np.random.default_rng(1)
    square = 2.0 / np.maximum(np.abs(np.cos(BEARINGS)), np.abs(np.sin(BEARINGS)))
    for ranges in (np.full(BEAMS, 3.0), square):
        scene = [[(r, rng.normal(48.0, 1.0))] for r in ranges + rng.normal(0.0, 0.02, BEAMS)]
        assert all(kept(turn(scene)[:beams]))
