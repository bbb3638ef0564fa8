# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Matches of which the guess is metres off, and places that look alike."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from stub_matcher import StubMatcher

from msss_graphslam.core.matching.match_result import MatchResult
from msss_graphslam.core.matching.wide_search import AMBIGUOUS, BASIN, MOST, match_widely
from msss_graphslam.core.types import Array

SCAN = SimpleNamespace(points=np.zeros((100, 2)))
SURE = np.diag([0.05, 0.05, 0.01]) ** 2
GUESS = np.array([1.0, 2.0, 0.3])


def guessed(along: float, across: float = 0.1, bearing: float = 0.0) -> Array:
    """Return the covariance (3, 3) of a guess that is wide in one direction."""
    axes = np.array([[np.cos(bearing), -np.sin(bearing)], [np.sin(bearing), np.cos(bearing)]])
    spread = np.diag([0.0, 0.0, 0.02**2])
    spread[:2, :2] = axes @ np.diag([along**2, across**2]) @ axes.T
    return spread


class Places(StubMatcher):
    """A matcher that finds one of several places (n, 3): the nearest, if it is near enough.

    ``overlaps`` (n,) are the shares of points that fit there. Nothing fits elsewhere.
    """

    def __init__(
        self, places: list[Array], overlaps: list[float], covariance: Array = SURE
    ) -> None:
        self._places = np.array(places)
        self._overlaps = overlaps
        self._covariance = covariance
        self.asked: list[tuple[Array, Array]] = []

    def answer(self, initial: Array, covariance: Array, start: Array | None) -> MatchResult:
        begin = initial if start is None else start
        self.asked.append((begin, covariance))
        distances = np.hypot(*(self._places - begin)[:, :2].T)
        nearest = int(distances.argmin())
        if distances[nearest] > 0.6 * BASIN:
            return MatchResult(begin, self._covariance, "too_little_overlap", {"overlap": 0.2})
        figures = {"overlap": self._overlaps[nearest]}
        return MatchResult(self._places[nearest].copy(), self._covariance, "", figures)


def place(along: float, bearing: float = 0.0) -> Array:
    return np.asarray(GUESS + along * np.array([np.cos(bearing), np.sin(bearing), 0.0]))


def widely(matcher: Places, covariance: Array) -> MatchResult:
    return match_widely(matcher, SCAN, SCAN, GUESS, covariance)


@pytest.mark.parametrize("bearing", [0.0, 0.8, 2.5])
@pytest.mark.parametrize("along", [-4.6, -2.0, 0.3, 2.0, 4.6])
def test_a_place_within_the_guess_is_found(along: float, bearing: float) -> None:
    there = place(along, bearing)
    found = widely(Places([there], [0.9]), guessed(1.6, bearing=bearing))
    assert found.accepted
    np.testing.assert_array_equal(found.relative_pose, there)


def test_a_place_beyond_the_guess_is_not() -> None:
    matcher = Places([place(8.0)], [0.9])
    found = widely(matcher, guessed(1.6))
    assert found.refusal == "too_little_overlap"
    np.testing.assert_array_equal(found.relative_pose, GUESS)


def test_what_more_points_support_is_taken_although_it_is_farther() -> None:
    """As where the face of a corner is taken for the end of the basin."""
    alike, true = place(0.1), place(4.0)
    found = widely(Places([alike, true], [0.6, 0.9]), guessed(1.6))
    assert found.accepted
    np.testing.assert_array_equal(found.relative_pose, true)


@pytest.mark.parametrize(("other", "refusal"), [(0.9, AMBIGUOUS), (0.85, AMBIGUOUS), (0.7, "")])
def test_two_that_fit_as_well_are_ambiguous(other: float, refusal: str) -> None:
    """Of 100 points 85 or 90 is chance, 70 or 90 is not."""
    found = widely(Places([place(0.0), place(4.0)], [0.9, other]), guessed(1.6))
    assert found.refusal == refusal


def test_one_that_is_found_from_several_starts_is_one() -> None:
    found = widely(Places([place(1.0), place(1.1)], [0.9, 0.9]), guessed(1.6))
    assert found.accepted
    np.testing.assert_array_equal(found.relative_pose, place(1.0))


def test_a_good_guess_is_matched_once() -> None:
    matcher = Places([place(0.1), place(1.9)], [0.6, 0.9])
    found = widely(matcher, guessed(0.6))
    assert len(matcher.asked) == 1
    np.testing.assert_array_equal(found.relative_pose, place(0.1))


def test_along_a_corridor_one_start_is_enough() -> None:
    matcher = Places([place(0.1), place(4.0)], [0.9, 0.9], np.diag([100.0, 0.05, 0.01]) ** 2)
    found = widely(matcher, guessed(1.6))
    assert found.accepted
    assert len(matcher.asked) == 1
    # Seen across, the same scans say where they are.
    across = Places([place(0.1)], [0.9], np.diag([0.05, 100.0, 0.01]) ** 2)
    assert widely(across, guessed(1.6)).accepted
    assert len(across.asked) > 1


def test_the_last_match_is_held_by_the_whole_guess() -> None:
    matcher = Places([place(4.0)], [0.9])
    covariance = guessed(1.6)
    widely(matcher, covariance)
    (_, first), *others, (begin, last) = matcher.asked
    np.testing.assert_array_equal(first, covariance)
    np.testing.assert_array_equal(last, covariance)
    np.testing.assert_array_equal(begin, place(4.0))
    for _, narrow in others:
        assert narrow[0, 0] == pytest.approx((0.5 * BASIN) ** 2)
        assert narrow[1, 1] == pytest.approx(0.1**2)
        assert narrow[2, 2] == covariance[2, 2]


@pytest.mark.parametrize("deviation", [50.0, 1e6])
def test_the_work_is_bounded(deviation: float) -> None:
    matcher = Places([place(1e9)], [0.9])
    assert not widely(matcher, guessed(deviation)).accepted
    assert len(matcher.asked) == 1 + 2 * MOST


def test_a_scan_without_enough_points_is_tried_once() -> None:
    asked = []

    class Empty(Places):
        def match(self, *arguments: Any) -> MatchResult:
            asked.append(arguments)
            return MatchResult(GUESS, SURE, "too_few_points")

    matcher = Empty([GUESS], [0.9])
    assert match_widely(matcher, None, SCAN, GUESS, guessed(5.0)).refusal == "too_few_points"
    assert len(asked) == 1


@pytest.mark.parametrize("variance", [0.0, -1e-12])
def test_a_guess_without_spread_is_matched_once(variance: float) -> None:
    matcher = Places([place(0.1)], [0.9])
    assert widely(matcher, np.diag([variance, 0.0, 0.0])).accepted
    assert len(matcher.asked) == 1
