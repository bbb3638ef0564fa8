# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Central differences, as an oracle for Jacobians."""

from collections.abc import Callable

import numpy as np

from msss_graphslam.core.types import Array

STEP = 1e-6


def jacobian(function: Callable[[Array], Array], at: Array) -> Array:
    """d function / d at, one column for each element of ``at``."""
    steps = STEP * np.eye(len(at))
    columns = [(function(at + step) - function(at - step)) / (2.0 * STEP) for step in steps]
    return np.stack(columns, axis=-1)
