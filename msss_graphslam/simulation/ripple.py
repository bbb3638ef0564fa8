# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Smooth, fixed differences between bearings, as every head and hull has its own."""

import numpy as np

from msss_graphslam.core.types import Array

__all__ = ["Ripple"]

_HARMONICS = np.arange(1, 7)


class Ripple:
    """A random smooth function of the bearing, of about unit standard deviation."""

    def __init__(self, generator: np.random.Generator) -> None:
        self._cosines, self._sines = generator.standard_normal((2, len(_HARMONICS)))

    def __call__(self, bearings: Array) -> Array:
        """Return the function's values at ``bearings`` (...) [rad]."""
        phases = bearings[..., None] * _HARMONICS
        waves = np.cos(phases) @ self._cosines + np.sin(phases) @ self._sines
        return np.asarray(waves / np.sqrt(len(_HARMONICS)))
