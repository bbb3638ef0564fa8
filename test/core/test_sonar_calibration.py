# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest
from moving_scans import BASIN, moving_scans

from msss_graphslam.core.compounding import compose
from msss_graphslam.core.scans.persistence import Persistence
from msss_graphslam.core.smoothing.normal_equations import NormalEquations
from msss_graphslam.core.smoothing.sonar_calibration import (
    OBSERVED,
    sonar_calibration,
    velocities_of,
)
from msss_graphslam.core.smoothing.twist_chain import TwistChain, durations_of
from msss_graphslam.core.types import Array, SonarCalibration

COUNT = 12
PERSISTENCE = Persistence(100.0, np.full(3, 1e-6))
SURE = 1e8
"""Information of the sonar's displacements [1/m^2, 1/rad^2]."""
BY_ENDS = np.tile(np.hstack([-0.1 * np.eye(3), 0.1 * np.eye(3)]), (COUNT, 1, 1))
SPEEDS = np.linspace(0.05, 0.25, COUNT)
VELOCITIES = np.column_stack([SPEEDS, 0.05 * np.cos(np.arange(COUNT))])


def complex_of(vectors: Array) -> Array:
    return np.asarray(vectors[:, 0] + 1j * vectors[:, 1])


def calibrated(
    yaw: float, scale: float, doubt: float, velocities: Array = VELOCITIES
) -> SonarCalibration | None:
    """What is found where the sonar says of each motion exactly what its errors make of it.

    ``doubt`` [m/s] is the deviation of the velocity sensor.
    """
    scans, _ = moving_scans(BASIN, COUNT, doubt=np.diag([doubt, doubt, 1e-3]) ** 2)
    seen = complex_of(velocities) * np.exp(-1j * yaw) / scale
    off = seen - complex_of(velocities)
    twists = np.column_stack([off.real, off.imag, np.zeros(COUNT)])
    chain, equations = TwistChain(scans, PERSISTENCE), NormalEquations(COUNT + 1)
    chain.add_to(equations, twists, BY_ENDS)
    nodes = np.column_stack([np.arange(COUNT), np.arange(COUNT) + 1])
    pulls = np.tile(np.kron([[1.0, -1.0], [-1.0, 1.0]], SURE * np.eye(3)), (COUNT, 1, 1))
    equations.add(nodes, pulls, np.zeros((COUNT, 6)))
    return sonar_calibration(chain, equations, twists, BY_ENDS, velocities)


@pytest.mark.parametrize(("yaw", "scale"), [(0.0, 1.0), (0.02, 1.0), (-0.01, 1.01), (0.0, 0.99)])
def test_a_head_askew_and_a_wrong_speed_of_sound_are_found(yaw: float, scale: float) -> None:
    found = calibrated(yaw, scale, 0.001)
    assert found is not None
    # The model is of first order.
    assert found.yaw == pytest.approx(yaw, abs=5e-4)
    assert found.scale == pytest.approx(scale, abs=5e-4)


def test_the_deviations_are_those_of_what_the_velocity_sensor_doubts() -> None:
    found, worse = calibrated(0.0, 1.0, 0.001), calibrated(0.0, 1.0, 0.002)
    assert found is not None
    assert worse is not None
    independent = 0.001 / np.sqrt((VELOCITIES**2).sum())
    # Errors that last tell less than independent ones.
    (yaw, scale), (less_sure, _) = found.deviations, worse.deviations
    assert yaw > 0.9 * independent
    assert less_sure > 1.2 * yaw
    assert yaw == pytest.approx(scale, rel=5e-7)


def test_it_is_told_only_where_both_are_known_well() -> None:
    doubts = np.geomspace(1e-4, 0.3, 40)
    found = [calibrated(0.0, 1.0, float(doubt)) for doubt in doubts]
    known = [entry for entry in found if entry is not None]
    assert 0 < len(known) < len(found)
    assert found[: len(known)] == known
    yaw, scale = np.max([entry.deviations for entry in known], axis=0)
    assert yaw < OBSERVED[1]
    assert scale < OBSERVED[0]
    assert max(yaw / OBSERVED[1], scale / OBSERVED[0]) > 0.5


def test_a_vehicle_at_rest_tells_nothing() -> None:
    assert calibrated(0.0, 1.0, 0.001, np.zeros((COUNT, 2))) is None


def test_velocities_are_those_of_arcs() -> None:
    twist = np.array([0.2, -0.05, 0.04])
    states = [np.array([1.0, 2.0, 0.7])]
    for _ in range(2000):
        states.append(compose(states[-1], twist * 0.01))
    found = velocities_of(np.array(states)[::500], np.full(4, 5.0))
    np.testing.assert_allclose(found, np.tile(twist[:2], (4, 1)), atol=1e-4)


def test_velocities_without_a_turn() -> None:
    states = np.array([[0.0, 0.0, np.pi / 2.0], [0.0, 3.0, np.pi / 2.0]])
    found = velocities_of(states, durations_of(moving_scans(BASIN, 1)[0]))
    np.testing.assert_allclose(found, [[0.3, 0.0]], atol=1e-12)
