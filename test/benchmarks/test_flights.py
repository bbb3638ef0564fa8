# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Simulated missions in memory and on disk."""

from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from short_missions import MISSION, shorten_missions

from benchmarks import flights
from benchmarks.flights import FlightCache, flown
from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.types import Beam, BodyVelocity, Depth, Inertial
from msss_graphslam.recordings.reader import open_recording
from msss_graphslam.simulation.inertial import NoiseLevel
from msss_graphslam.simulation.recording import simulate


@pytest.fixture(autouse=True)
def _short(monkeypatch: pytest.MonkeyPatch) -> None:
    shorten_missions(monkeypatch, metres=1.5)


def test_a_flight_measures_what_its_bag_holds(tmp_path: Path) -> None:
    mission = replace(MISSION, dvl=True, noise=NoiseLevel.HIGH)
    bag = simulate(
        mission.place, 3, tmp_path, noise=mission.noise, echo=mission.echo, dvl=True
    ).bag
    recording = open_recording(bag)
    recorded = list(recording.measurements(Counter(), Configuration()))
    flight = flown(mission)
    measured = list(flight.measurements())
    assert [(type(entry), entry.stamp_ns) for entry in measured] == [
        (type(entry), entry.stamp_ns) for entry in recorded
    ]
    names = {
        Beam: ("bearing", "ranges", "intensities"),
        Inertial: ("orientation", "angular_velocity"),
        Depth: ("z",),
        BodyVelocity: ("velocity", "covariance"),
    }
    for ours, other in zip(measured, recorded, strict=True):
        for name in names[type(ours)]:
            np.testing.assert_allclose(getattr(ours, name), getattr(other, name), atol=1e-12)
    truth = recording.ground_truth()
    assert truth is not None
    assert (flight.truth.stamps_ns == truth.stamps_ns).all()
    np.testing.assert_allclose(flight.truth.planar, truth.planar, atol=1e-12)


def test_a_mission_is_simulated_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    first = FlightCache(tmp_path, "abc").get(MISSION)
    monkeypatch.setattr(flights, "flown", lambda _: pytest.fail("simulated again"))
    again = FlightCache(tmp_path, "abc").get(MISSION)
    assert first.arrays.keys() == again.arrays.keys()
    for name, values in first.arrays.items():
        np.testing.assert_array_equal(values, again.arrays[name])


@pytest.mark.parametrize("spoilt", ["outdated", "cut", "empty", "of something else"])
def test_a_flight_that_cannot_serve_is_simulated_anew(tmp_path: Path, spoilt: str) -> None:
    cache = FlightCache(tmp_path, "abc")
    whole = cache.get(MISSION).arrays["codes"]
    (path,) = tmp_path.iterdir()
    if spoilt == "outdated":
        np.savez(path, sources=np.array("abd"), codes=np.zeros(3))
    elif spoilt == "of something else":
        np.savez(path, codes=np.zeros(3))
    else:
        path.write_bytes(path.read_bytes()[: 1000 if spoilt == "cut" else 0])
    np.testing.assert_array_equal(cache.get(MISSION).arrays["codes"], whole)
    assert list(tmp_path.iterdir()) == [path]


def test_every_change_of_a_mission_is_another_file() -> None:
    changed = [
        MISSION,
        replace(MISSION, seed=4),
        replace(MISSION, noise=NoiseLevel.HIGH),
        replace(MISSION, dvl=True),
        replace(MISSION, sonar=(("step", 0.01),)),
        replace(MISSION, sonar=(("step", 0.02),)),
        replace(MISSION, sonar=(("bins", 100),)),
    ]
    assert len({str(mission) for mission in changed}) == len(changed)
    assert not any("/" in str(mission) for mission in changed)


def test_changes_of_the_sonar_arrive() -> None:
    flight = flown(replace(MISSION, sonar=(("bins", 77), ("maximum_range", 30.0))))
    assert flight.arrays["codes"].shape[1] == 77
    assert flight.arrays["ranges"][-1] == pytest.approx(30.0 * (1.0 - 0.5 / 77))
