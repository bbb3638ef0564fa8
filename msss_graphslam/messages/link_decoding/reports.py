# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""A keyframe and the constraints that the front end has tried for it, to its report."""

import re
from math import isfinite
from typing import Any

import numpy as np

from msss_graphslam.core.types import Array, Constraint, ConstraintKind, KeyframeReport, TwistError
from msss_graphslam.messages.fields import stamp_of
from msss_graphslam.messages.refusal import Refusal

__all__ = ["tried"]

_KEYFRAME = re.compile(r"keyframe_([0-9]{1,9})")
_EDGE = re.compile(r"keyframe_([0-9]{1,9}) -> keyframe_([0-9]{1,9})")
_FIGURE = "figure/"


def tried(message: Any) -> KeyframeReport:
    """Return the report of ``encoding.tried``."""
    if not message.status:
        raise Refusal("tried_without_keyframe")
    keyframe, *edges = message.status
    named = _KEYFRAME.fullmatch(keyframe.name)
    if named is None:
        raise Refusal("tried_names")
    number, values = int(named[1]), _values(keyframe)
    return KeyframeReport(
        number=number,
        stamp_ns=stamp_of(message, "tried"),
        pose=_row(values, "pose", 3),
        odometry=_row(values, "odometry", 3),
        twist_error=TwistError(
            _row(values, "twist_error", 3),
            _row(values, "twist_error_covariance", 9).reshape(3, 3),
        ),
        constraints=tuple(_constraint(status, number) for status in edges),
    )


def _constraint(status: Any, number: int) -> Constraint:
    named = _EDGE.fullmatch(status.name)
    if named is None or not int(named[1]) < int(named[2]) == number:
        raise Refusal("tried_names")
    if status.hardware_id not in set(ConstraintKind):
        raise Refusal("tried_kind")
    if (status.level in (0, b"\x00")) != (not status.message):
        raise Refusal("tried_level")
    values = _values(status)
    return Constraint(
        kind=ConstraintKind(status.hardware_id),
        first=int(named[1]),
        second=number,
        relative_pose=_row(values, "relative_pose", 3),
        covariance=_row(values, "covariance", 9).reshape(3, 3),
        refusal=status.message,
        figures={
            key.removeprefix(_FIGURE): float(_row(values, key, 1)[0])
            for key in values
            if key.startswith(_FIGURE)
        },
    )


def _values(status: Any) -> dict[str, str]:
    return {entry.key: entry.value for entry in status.values}


def _row(values: dict[str, str], key: str, size: int) -> Array:
    """Return the numbers (size,) that stand under the key."""
    words = values.get(key, "").split()
    if len(words) != size:
        raise Refusal("tried_values")
    try:
        row = [float(word) for word in words]
    except ValueError:
        raise Refusal("tried_values") from None
    if not all(map(isfinite, row)):
        raise Refusal("tried_not_finite")
    return np.array(row)
