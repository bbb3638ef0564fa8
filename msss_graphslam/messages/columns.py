# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The columns of the point clouds by which the nodes tell each other records without loss."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from msss_graphslam.core.types import Stamps
from msss_graphslam.messages.refusal import Refusal

__all__ = [
    "BEAMS",
    "DATATYPES",
    "POSES",
    "SETTLED",
    "read_columns",
    "read_stamps",
    "set_stamps",
]

Rows = NDArray[np.void]

_STAMP = [("sec", "<i4"), ("nanosec", "<u4")]

SETTLED = np.dtype(
    [
        *_STAMP,
        ("pose", "<f8", (6,)),
        ("covariance", "<f8", (36,)),
        ("twist", "<f8", (6,)),
        ("twist_covariance", "<f8", (36,)),
    ]
)
"""Dead reckoning; a row is an Odometry."""

BEAMS = np.dtype(
    [
        *_STAMP,
        ("reckoned", "<f8", (6,)),
        ("echo", "u1"),
        ("body_point", "<f8", (2,)),
        ("body_covariance", "<f8", (4,)),
        ("twist_covariance", "<f8", (9,)),
        ("complete", "u1"),
        ("usable", "u1"),
    ]
)
"""A scan; a row is a beam, the last one the end of the turn."""

POSES = np.dtype(
    [
        *_STAMP,
        ("pose", "<f8", (3,)),
        ("odometry", "<f8", (3,)),
        ("covariance", "<f8", (9,)),
    ]
)
"""The graph; a row is a keyframe."""

DATATYPES = {"u1": 2, "i4": 5, "u4": 6, "f8": 8}
"""sensor_msgs/PointField's numbers of the types above."""

_NANOSECONDS = 1_000_000_000
_LARGEST_STEP = 1 << 16  # bytes a row; the widest layout above has under 700


def read_columns(message: Any, layout: np.dtype[np.void], name: str) -> Rows:
    """Return the rows of a sensor_msgs/PointCloud2 in the layout; further fields are passed over.

    Raises Refusal where a field lacks or differs, the data do not fill the rows, or a number is
    not finite.
    """
    data = np.ascontiguousarray(message.data, dtype=np.uint8)
    step, width = int(message.point_step), int(message.width)
    if message.height != 1 or not 0 < step <= _LARGEST_STEP or data.size != step * width:
        raise Refusal(f"{name}_size")
    sent = data.view(_dtype_as_sent(message, layout, step, name))
    rows = np.empty(width, dtype=layout)
    for column in layout.names or ():
        rows[column] = sent[column]
        if not np.isfinite(rows[column]).all():
            raise Refusal(f"{name}_not_finite")
    return rows


def read_stamps(rows: Rows, name: str) -> Stamps:
    """Return the rows' stamps (n,) [ns]; raises Refusal where one is none."""
    if (rows["sec"] < 0).any() or (rows["nanosec"] >= _NANOSECONDS).any():
        raise Refusal(f"{name}_stamp_invalid")
    return np.asarray(rows["sec"].astype(np.int64) * _NANOSECONDS + rows["nanosec"])


def set_stamps(rows: Rows, stamps_ns: Stamps) -> None:
    """Write the rows' stamps (n,) [ns]."""
    rows["sec"], rows["nanosec"] = np.divmod(stamps_ns, _NANOSECONDS)


def _dtype_as_sent(
    message: Any, layout: np.dtype[np.void], step: int, name: str
) -> np.dtype[np.void]:
    sent = {field.name: field for field in message.fields}
    order = ">" if message.is_bigendian else "<"
    names = list(layout.names or ())
    formats: list[Any] = []
    offsets: list[int] = []
    for column in names:
        kind = layout[column]
        code, count = kind.base.str[1:], int(np.prod(kind.shape, dtype=int))
        field = sent.get(column)
        if field is None or (field.datatype, field.count) != (DATATYPES[code], count):
            raise Refusal(f"{name}_fields")
        if field.offset + kind.itemsize > step:
            raise Refusal(f"{name}_fields")
        formats.append((order + code, kind.shape))
        offsets.append(int(field.offset))
    return np.dtype({"names": names, "formats": formats, "offsets": offsets, "itemsize": step})
