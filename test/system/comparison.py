# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Whether two directories hold the same result."""

import csv
import json
from pathlib import Path
from typing import Any

import numpy as np

from msss_graphslam.core.types import Trajectory
from msss_graphslam.results.tum import read_trajectory

__all__ = ["accepted", "assert_near", "assert_same", "length", "refused", "summary"]

_SAME = 1e-6
_NEAR = 0.01


def assert_same(made: Path, expected: Path) -> None:
    """Same keyframes, same accepted edges, the same trajectory to 1e-6 m."""
    _assert_equal(made / "keyframes.tum", expected / "keyframes.tum")
    assert accepted(made) == accepted(expected)
    _assert_equal(made / "trajectory.tum", expected / "trajectory.tum")


def assert_near(made: Path, expected: Path) -> None:
    """End and length of the trajectory differ by at most 1 % of the length."""
    ours, theirs = (read_trajectory(folder / "trajectory.tum") for folder in (made, expected))
    bound = _NEAR * length(theirs)
    assert abs(length(ours) - length(theirs)) <= bound
    assert np.linalg.norm(ours.poses[-1, :2] - theirs.poses[-1, :2]) <= bound


def accepted(folder: Path) -> list[tuple[str, int, int]]:
    """The accepted constraints: kind and keyframes."""
    with (folder / "constraints.csv").open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    edges = [row for row in rows if row["accepted"] == "yes"]
    return sorted((row["kind"], int(row["first"]), int(row["second"])) for row in edges)


def length(trajectory: Trajectory) -> float:
    """The length of the way [m]."""
    return float(np.linalg.norm(np.diff(trajectory.poses[:, :2], axis=0), axis=1).sum())


def summary(folder: Path) -> dict[str, Any]:
    """What summary.json holds."""
    content: dict[str, Any] = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    return content


def refused(folder: Path) -> dict[str, int]:
    """The refused data by reason."""
    counts: dict[str, int] = summary(folder)["refused"]
    return counts


def _assert_equal(made: Path, expected: Path) -> None:
    ours, theirs = read_trajectory(made), read_trajectory(expected)
    np.testing.assert_array_equal(ours.stamps_ns, theirs.stamps_ns)
    np.testing.assert_allclose(ours.poses, theirs.poses, rtol=0.0, atol=_SAME)
