# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Two ways to make the same message: rclpy's classes and the bag library's."""

import array
import importlib
from typing import Any

import numpy as np


def make_rclpy(type_name: str, **fields: Any) -> Any:
    """Make an rclpy message, its sequences as array.array."""
    package, _, name = type_name.split("/")
    message = getattr(importlib.import_module(f"{package}.msg"), name)()
    for field, value in fields.items():
        is_fixed = isinstance(getattr(message, field), np.ndarray)
        if isinstance(value, np.ndarray) and not is_fixed:
            value = array.array(value.dtype.char, value.tobytes())
        setattr(message, field, value)
    return message
