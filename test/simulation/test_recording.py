# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.types import Beam, BodyVelocity, Depth, Inertial
from msss_graphslam.errors import UserError
from msss_graphslam.recordings.reader import open_recording
from msss_graphslam.simulation.echo_model import EchoKind
from msss_graphslam.simulation.inertial import NoiseLevel
from msss_graphslam.simulation.mission import Mission, fly
from msss_graphslam.simulation.recording import SimulatedBag, simulate
from msss_graphslam.simulation.worlds import World, world_named


def small_world() -> World:
    """The paper's world with a path of 1.5 m and coarse settings."""
    world = world_named("paper")
    path = world.path
    count = 75
    short = replace(
        path,
        points=path.points[:count],
        tangents=path.tangents[:count],
        arc_lengths=path.arc_lengths[:count],
    )
    return replace(world, path=short, laps=1, sonar=replace(world.sonar, bins=100))


def mission(seed: int = 1, **changes: object) -> Mission:
    world = small_world()
    options = {
        "noise": NoiseLevel.PAPER,
        "echo": EchoKind.REAL,
        "sonar": world.sonar,
        "dvl": False,
        "progress": lambda _: None,
    }
    return fly(world, seed, **{**options, **changes})  # type: ignore[arg-type]


@pytest.fixture(scope="module")
def bag(tmp_path_factory: pytest.TempPathFactory) -> SimulatedBag:
    return simulate(small_world(), 5, tmp_path_factory.mktemp("simulated"), dvl=True)


def test_a_bag_holds_every_sensor_and_nothing_that_is_refused(bag: SimulatedBag) -> None:
    refusals: Counter[str] = Counter()
    measurements = list(open_recording(bag.bag).measurements(refusals, Configuration()))
    assert not refusals
    kinds = Counter(type(measurement) for measurement in measurements)
    beams = [measurement for measurement in measurements if isinstance(measurement, Beam)]
    span = (beams[-1].stamp_ns - beams[0].stamp_ns) * 1e-9
    for kind, rate in ((Beam, 20.0), (Inertial, 25.0), (Depth, 10.0), (BodyVelocity, 5.0)):
        assert kinds[kind] / span == pytest.approx(rate, rel=0.1)
    np.testing.assert_allclose(beams[0].ranges[[0, -1]], [0.12, 23.88], atol=1e-5)


def test_the_truth_begins_at_the_origin_of_map(bag: SimulatedBag) -> None:
    truth = open_recording(bag.bag).ground_truth()
    assert truth is not None
    np.testing.assert_allclose(truth.poses[0, :2], 0.0, atol=1e-9)
    rows = np.loadtxt(bag.ground_truth)
    np.testing.assert_allclose(rows[:, 1:4], truth.poses[:, :3], atol=1e-8)
    np.testing.assert_allclose(np.linalg.norm(rows[:, 4:], axis=1), 1.0, atol=1e-8)
    yaw = 2.0 * np.arctan2(rows[0, 6], rows[0, 7])
    assert yaw == pytest.approx(truth.poses[0, 5], abs=0.01)
    first = bag.ground_truth.read_text(encoding="ascii").split(maxsplit=1)[0]
    assert int(first.replace(".", "")) == truth.stamps_ns[0]


def test_the_same_seed_gives_the_same_bytes(bag: SimulatedBag, tmp_path: Path) -> None:
    again = simulate(small_world(), 5, tmp_path, dvl=True)
    for file in sorted(bag.bag.iterdir()):
        assert file.read_bytes() == (again.bag / file.name).read_bytes()
    assert bag.ground_truth.read_bytes() == again.ground_truth.read_bytes()


def test_another_seed_gives_another_mission() -> None:
    first, second = mission(1), mission(2)
    assert first.motion.duration != second.motion.duration


@pytest.mark.parametrize("changes", [{"echo": EchoKind.IDEAL}, {"dvl": True}])
def test_changing_one_source_leaves_the_others_alone(changes: dict[str, object]) -> None:
    plain, changed = mission(), mission(**changes)
    np.testing.assert_array_equal(plain.motion.poses, changed.motion.poses)
    np.testing.assert_array_equal(plain.inertial.orientations, changed.inertial.orientations)
    np.testing.assert_array_equal(
        plain.inertial.angular_velocities, changed.inertial.angular_velocities
    )
    np.testing.assert_array_equal(plain.pressure.pressures, changed.pressure.pressures)
    np.testing.assert_array_equal(plain.sonar.times, changed.sonar.times)
    np.testing.assert_array_equal(plain.sonar.bearings, changed.sonar.bearings)
    assert (changed.velocity is not None) == ("dvl" in changes)
    assert np.array_equal(plain.sonar.codes, changed.sonar.codes) == ("echo" not in changes)


def test_an_existing_bag_is_not_overwritten(bag: SimulatedBag) -> None:
    before = bag.ground_truth.read_bytes()
    with pytest.raises(UserError, match="exists already"):
        simulate(small_world(), 5, bag.bag.parent)
    assert bag.ground_truth.read_bytes() == before


def test_progress_rises_to_one(tmp_path: Path) -> None:
    seen: list[float] = []
    simulate(small_world(), 1, tmp_path, progress=seen.append)
    assert seen == sorted(seen)
    assert seen[-1] == 1.0
