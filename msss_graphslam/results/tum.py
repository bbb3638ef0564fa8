# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Trajectories in the format of the TUM RGB-D benchmark: ``t x y z qx qy qz qw``, s and m."""

import re
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from msss_graphslam.core.types import Array, Stamps, Trajectory
from msss_graphslam.errors import UserError
from msss_graphslam.results.atomic import write_text

__all__ = ["format_trajectory", "read_trajectory", "write_trajectory"]

_NANOSECONDS = 1_000_000_000
_OWN_TIME = re.compile(r"-?\d{1,10}\.\d{9}", re.ASCII)
_LINE = (
    " ".join(
        [
            "%s%d.%09d",
            *["%.9f"] * 7,
        ]
    )
    + "\n"
)


def write_trajectory(path: Path, trajectory: Trajectory) -> None:
    """Write the trajectory, a pose a line."""
    write_text(path, format_trajectory(trajectory))


def format_trajectory(trajectory: Trajectory) -> str:
    """Return the file's text, stamps to 1e-9 s, poses to 1e-9: equal poses make equal bytes."""
    if not len(trajectory.stamps_ns):
        return ""  # SciPy 1.11, Ubuntu 24.04's, takes no empty set of rotations.
    quaternions = Rotation.from_euler("ZYX", trajectory.poses[:, :2:-1]).as_quat(canonical=True)
    # Adding zero turns -0.0 into 0.0.
    rows = np.round(np.hstack([trajectory.poses[:, :3], quaternions]), 9) + 0.0
    stamps = trajectory.stamps_ns
    signs = np.where(stamps < 0, "-", "")
    seconds, rests = np.divmod(np.abs(stamps), _NANOSECONDS)
    columns = (signs, seconds, rests, *rows.T)
    return "".join(_LINE % row for row in zip(*map(np.ndarray.tolist, columns), strict=True))


def read_trajectory(path: Path) -> Trajectory:
    """Read a trajectory; empty lines and lines that start with # are passed over.

    Raises
    ------
    UserError
        Where the file cannot be read, a line has not eight finite numbers, a quaternion is zero,
        stamps do not increase, or there is no pose at all.
    """
    lines = _lines(path)
    try:
        stamps, rows = _parse_own(lines)
    except ValueError:
        stamps, rows = _parse_any(lines, path)
    return _trajectory(stamps, rows, path)


def _lines(path: Path) -> list[str]:
    try:
        return path.read_text(encoding="utf-8").splitlines()
    except FileNotFoundError as error:
        raise UserError(f"{path}: no such file; give a trajectory in TUM format") from error
    except (OSError, UnicodeDecodeError) as error:
        raise UserError(f"{path}: cannot be read as a TUM trajectory ({error})") from error


def _parse_own(lines: list[str]) -> tuple[Stamps, Array]:
    """Parse what this package writes, in a seventh of the time; ValueError for anything else."""
    if not lines or any(line.count(" ") != 7 for line in lines):
        raise ValueError("not eight words")
    times = [line.partition(" ")[0] for line in lines]
    if not all(_OWN_TIME.fullmatch(time) for time in times):
        raise ValueError("other times")
    rows = np.loadtxt(lines, usecols=range(1, 8), comments=None, ndmin=2)
    if not np.isfinite(rows).all() or not rows[:, 3:].any(axis=1).all():
        raise ValueError("no pose")
    return np.array([int(time.replace(".", "")) for time in times], dtype=np.int64), rows


def _parse_any(lines: list[str], path: Path) -> tuple[Stamps, Array]:
    stamps, rows = [], []
    for number, line in enumerate(lines, start=1):
        if line.strip() and not line.lstrip().startswith("#"):
            stamp, row = _parse(line, f"{path}, line {number}")
            stamps.append(stamp)
            rows.append(row)
    if not rows:
        raise UserError(f"{path}: holds no pose; expected lines of 't x y z qx qy qz qw'")
    return np.array(stamps, dtype=np.int64), np.array(rows)


def _parse(line: str, where: str) -> tuple[int, list[float]]:
    words = line.split()
    try:
        stamp, row = _nanoseconds(words[0]), [float(word) for word in words[1:]]
    except (ValueError, OverflowError) as error:
        raise UserError(f"{where}: not a number ({error})") from error
    if len(row) != 7 or not np.all(np.isfinite(row)):
        raise UserError(f"{where}: expected eight finite numbers 't x y z qx qy qz qw'")
    if not any(row[3:]):
        raise UserError(f"{where}: the quaternion is zero, which is no orientation")
    return stamp, row


def _trajectory(stamps: Stamps, rows: Array, path: Path) -> Trajectory:
    late = np.flatnonzero(np.diff(stamps) <= 0)
    if late.size:
        raise UserError(
            f"{path}: stamps must increase, but pose {late[0] + 2} is no later than the last"
        )
    angles = Rotation.from_quat(rows[:, 3:]).as_euler("ZYX")[:, ::-1]
    return Trajectory(stamps, np.hstack([rows[:, :3], angles]))


def _nanoseconds(text: str) -> int:
    """Parse seconds without the rounding of a float, which has 1e-7 s at today's epoch."""
    if "e" in text.lower():
        return round(float(text) * _NANOSECONDS)
    whole, _, fraction = text.partition(".")
    rest = int((fraction + "0" * 9)[:9])
    return int(whole) * _NANOSECONDS + (-rest if whole.startswith("-") else rest)
