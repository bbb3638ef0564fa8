# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Many messages of one layout, made as bytes at once: they differ in stamps and numbers alone."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from msss_graphslam.core.types import Array, Stamps, Trajectory
from msss_graphslam.messages.encoding.cdr import CdrWriter
from msss_graphslam.messages.encoding.serialised import quaternions
from msss_graphslam.messages.frames import BASE_LINK, MAP, ODOM

__all__ = ["odometries", "planar_poses", "transforms"]

_NANOSECONDS = 1_000_000_000
_PLANAR = np.array([0, 1, 5])


def odometries(track: Trajectory, twists: Array) -> list[bytes]:
    """Return each pose as a nav_msgs/Odometry with its twist (n, 6), covariances zero."""
    batch = _Batch(track.stamps_ns)
    batch.header(ODOM)
    batch.writer.text(BASE_LINK)
    unknown = np.zeros((len(twists), 36))
    batch.numbers(_placed(track.poses), unknown, twists, unknown)
    return batch.messages()


def planar_poses(track: Trajectory, covariances: Array) -> list[bytes]:
    """Return each as a geometry_msgs/PoseWithCovarianceStamped in ``map``.

    ``covariances`` (n, 3, 3) are those of x, y, yaw.
    """
    batch = _Batch(track.stamps_ns)
    batch.header(MAP)
    spread = np.zeros((len(covariances), 6, 6))
    spread[:, _PLANAR[:, None], _PLANAR] = covariances
    batch.numbers(_placed(track.poses), spread.reshape(-1, 36))
    return batch.messages()


def transforms(stamps_ns: Stamps, placements: Sequence[tuple[Array, str, str]]) -> list[bytes]:
    """Return tf2_msgs/TFMessages, each with every placement (n, 6) of a child in a frame."""
    batch = _Batch(stamps_ns)
    batch.writer.numbers("I", len(placements))
    for poses, frame_id, child_frame_id in placements:
        batch.header(frame_id)
        batch.writer.text(child_frame_id)
        batch.numbers(_placed(poses))
    return batch.messages()


class _Batch:
    """Bytes of all the messages, and where their stamps and numbers go."""

    def __init__(self, stamps_ns: Stamps) -> None:
        self.writer = CdrWriter()
        parts = np.stack(np.divmod(stamps_ns, _NANOSECONDS), axis=-1)
        self._stamps = np.ascontiguousarray(parts, dtype="<u4").view(np.uint8)
        self._blocks: list[tuple[int, NDArray[np.uint8]]] = []

    def header(self, frame_id: str) -> None:
        """Write a header with the stamp of each message."""
        self.writer.align(4)
        self._blocks.append((len(self.writer.data), self._stamps))
        self.writer.header(0, frame_id)

    def numbers(self, *columns: Array) -> None:
        """Write the numbers (n, m) of each message, one array after the other."""
        self.writer.align(8)
        values = np.ascontiguousarray(np.hstack(columns), dtype="<f8")
        self._blocks.append((len(self.writer.data), values.view(np.uint8)))
        self.writer.numbers("d", *np.zeros(values.shape[1]))

    def messages(self) -> list[bytes]:
        """Return all messages."""
        rows = np.tile(np.frombuffer(self.writer.data, np.uint8), (len(self._stamps), 1))
        for start, values in self._blocks:
            rows[:, start : start + values.shape[1]] = values
        return [row.tobytes() for row in rows]


def _placed(poses: Array) -> Array:
    """Return position and quaternion (n, 7) of poses (n, 6)."""
    return np.hstack([poses[:, :3], quaternions(poses[:, 3:])])
