# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
from collections import Counter

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from reckoned import CONFIG, START_NS, beam, depth, imu, nanoseconds, times
from same_odometry import said

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.reckoning.dead_reckoning import DeadReckoning
from msss_graphslam.core.reckoning.prompt_dead_reckoning import PromptDeadReckoning
from msss_graphslam.core.types import (
    Beam,
    BodyVelocity,
    Depth,
    Inertial,
    Measurement,
    Odometry,
)

CONFIGURATION = Configuration()
PATIENCE, WINDOW = CONFIGURATION.sensors.patience, CONFIGURATION.sensors.reorder_window


def mission(duration: float = 12.0) -> list[Measurement]:
    """Slow samples of all sensors, in the order of their stamps; no two share one."""
    entries: list[Measurement] = [imu(at, 0.1 * at, 0.1) for at in times(0.0, duration, 0.1)]
    entries += [depth(at, -0.002 * at) for at in times(0.033, duration, 0.25)]
    entries += [
        BodyVelocity(nanoseconds(at), np.array([0.2, 0.01, 0.0]), 1e-4 * np.eye(3))
        for at in times(0.061, duration, 0.2)
    ]
    entries += [beam(at) for at in times(0.017, duration, 0.3)]
    return sorted(entries, key=lambda entry: entry.stamp_ns)


class Prompt:
    """What came of measurements in the order in which they arrived."""

    def __init__(self) -> None:
        self.refused: Counter[str] = Counter()
        self.settled: list[Odometry] = []
        self.prompt: list[Odometry | None] = []
        self.reckoning = PromptDeadReckoning(CONFIGURATION, self.refused)

    def feed(self, *arrivals: Measurement) -> "Prompt":
        for arrival in arrivals:
            answer = self.reckoning.process(arrival)
            self.settled += answer.settled
            self.prompt.append(answer.prompt)
        return self

    def finish(self) -> "Prompt":
        self.settled += self.reckoning.finish()
        return self

    @property
    def prompts(self) -> list[Odometry]:
        return [entry for entry in self.prompt if entry is not None]


def in_order(measurements: list[Measurement]) -> tuple[list[Odometry], Counter[str]]:
    """The oracle: one filter over the measurements by their stamps."""
    refused: Counter[str] = Counter()
    reckoning = DeadReckoning(CONFIG, refused)
    entries = [entry for one in measurements for entry in reckoning.process(one)]
    return entries + reckoning.start(), refused


def arrived(lags: dict[type, float], jitter: float = 0.0, seed: int = 0) -> list[Measurement]:
    rng = np.random.default_rng(seed)
    entries = mission()
    at = [
        one.stamp_ns * 1e-9 - START_NS * 1e-9 + lags.get(type(one), 0.0) + jitter * rng.random()
        for one in entries
    ]
    return [entries[index] for index in np.argsort(at, kind="stable")]


@given(st.lists(st.floats(0.0, PATIENCE - 0.5), min_size=4, max_size=4))
@settings(max_examples=10, deadline=None)
def test_settled_is_the_filter_in_order_whatever_the_lags(lags: list[float]) -> None:
    kinds = (Beam, BodyVelocity, Depth, Inertial)
    run = Prompt().feed(*arrived(dict(zip(kinds, lags, strict=True)))).finish()
    expected, refused = in_order(mission())
    assert said(run.settled) == said(expected)
    assert run.refused == refused


@pytest.mark.parametrize("seed", range(5))
def test_settled_is_the_filter_in_order_whatever_the_jitter(seed: int) -> None:
    arrivals = arrived({}, jitter=WINDOW, seed=seed)
    assert [one.stamp_ns for one in arrivals] != [one.stamp_ns for one in mission()]
    run = Prompt().feed(*arrivals).finish()
    assert said(run.settled) == said(in_order(mission())[0])
    assert not run.refused


def test_prompt_is_the_same_at_once_where_all_arrive_in_order() -> None:
    run = Prompt().feed(*mission())
    expected, _ = in_order(mission())
    aligned = nanoseconds(CONFIG.alignment_time)
    assert said(run.prompts) == said([one for one in expected if one.stamp_ns >= aligned])
    assert run.settled[-1].stamp_ns < run.prompts[-1].stamp_ns


def test_prompt_comes_with_the_measurement_itself() -> None:
    for measurement, prompt in zip(mission(), Prompt().feed(*mission()).prompt, strict=True):
        if prompt is not None:
            assert prompt.stamp_ns == measurement.stamp_ns


@pytest.mark.parametrize("seed", range(5))
def test_prompt_never_goes_back(seed: int) -> None:
    run = Prompt().feed(*arrived({BodyVelocity: 1.0}, jitter=2.0 * WINDOW, seed=seed))
    stamps = [entry.stamp_ns for entry in run.prompts]
    assert len(stamps) > 50
    assert (np.diff(stamps) > 0).all()


def test_what_is_late_is_in_the_next_prompt() -> None:
    """As if it had come in time."""
    entries = mission()
    late = next(one for one in entries[150:] if isinstance(one, BodyVelocity))
    before = [one for one in entries if one is not late]
    at = next(k for k, one in enumerate(before) if one.stamp_ns > late.stamp_ns) + 4
    run = Prompt().feed(*before[:at], late, *before[at : at + 4])
    expected = {one.stamp_ns: one for one in in_order(sorted(entries[: at + 5], key=stamp))[0]}
    assert said(run.prompts[-1:]) == said([expected[run.prompts[-1].stamp_ns]])
    without = Prompt().feed(*before[: at + 4]).prompts[-1]
    assert without.stamp_ns == run.prompts[-1].stamp_ns
    assert said([without]) != said(run.prompts[-1:])


def stamp(entry: Measurement) -> int:
    return entry.stamp_ns


def test_a_late_one_that_says_nothing_new_brings_no_prompt() -> None:
    entries = mission()
    run = Prompt().feed(*entries)
    assert run.prompts[-1].stamp_ns == entries[-1].stamp_ns
    assert run.reckoning.process(depth(11.99, -0.024)).prompt is None


def test_what_no_longer_fits_is_counted_once_and_changes_nothing() -> None:
    entries = mission()
    run, other = Prompt().feed(*entries[:200]), Prompt().feed(*entries[:200])
    answer = run.reckoning.process(depth(1.0, 50.0))
    assert (answer.settled, answer.prompt) == ([], None)
    assert run.refused == {"later_than_reorder_window": 1}
    run.feed(*entries[200:]).finish()
    other.feed(*entries[200:]).finish()
    assert said(run.settled) == said(other.settled)
    assert said(run.prompts) == said(other.prompts)


def test_refusals_are_those_of_the_settled_filter_alone() -> None:
    """A measurement goes through both filters, the fork's more than once."""
    entries = [*mission(), depth(6.005, 500.0)]
    entries.sort(key=stamp)
    arrivals = entries.copy()
    arrivals[200:202] = arrivals[201], arrivals[200]
    run = Prompt().feed(*arrivals).finish()
    assert run.refused == in_order(entries)[1] == {"depth_innovation": 1}


def test_resumed_both_go_on_from_the_earlier_pose() -> None:
    pose = np.array([5.0, -3.0, -1.0, 0.0, 0.0, 1.0])
    run = Prompt()
    run.reckoning.resume(nanoseconds(-1.0), pose)
    run.feed(*[imu(at, 1.0) for at in times(0.0, 8.0)])
    assert run.prompts[0].stamp_ns == nanoseconds(0.0)
    way = run.prompts[0].pose[:2] - pose[:2]
    expected = CONFIG.surge_speed * np.array([np.cos(1.0), np.sin(1.0)])
    np.testing.assert_allclose(way, expected, atol=1e-9)
    assert said(run.settled) == said(run.prompts[: len(run.settled)])
    assert len(run.settled) > 50


def test_finish_without_anything() -> None:
    assert Prompt().finish().settled == []


def test_shorter_than_the_alignment_is_settled_at_the_end() -> None:
    entries = [one for one in mission() if one.stamp_ns < nanoseconds(0.5 * CONFIG.alignment_time)]
    run = Prompt().feed(*entries)
    assert run.prompts == run.settled == []
    assert said(run.finish().settled) == said(in_order(entries)[0])
    assert run.settled
