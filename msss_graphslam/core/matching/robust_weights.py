# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What residuals say of their own size, and how much each of them counts."""

import numpy as np

from msss_graphslam.core.types import Array

__all__ = ["LEAST_SCALE", "cauchy_weights", "robust_size"]

CAUCHY = 2.0
"""Residual, in robust standard deviations, at which a pair's weight is halved."""

LEAST_SCALE = 0.1
"""Residuals smaller than this share of their stated deviations are luck."""


def robust_size(residuals: Array) -> float:
    """Return the standard deviation that normalised residuals (n,) speak of, 1 without any."""
    sizes, middle = np.abs(residuals), len(residuals) // 2
    return 1.4826 * float(np.partition(sizes, middle)[middle]) if len(sizes) else 1.0


def cauchy_weights(residuals: Array, scale: float) -> Array:
    """Return Cauchy's weights (n,) of normalised residuals whose robust size is ``scale``."""
    return np.asarray(1.0 / (1.0 + (residuals / (CAUCHY * max(scale, LEAST_SCALE))) ** 2))
