# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Speckle: the interference of many scatterers within one cell."""

import numpy as np

from msss_graphslam.core.types import Array
from msss_graphslam.simulation.streams import stream

__all__ = ["Speckle"]

_LOOKS = 3.0
_NEIGHBOUR = 0.2


class Speckle:
    """Multiplies powers by gamma noise of unit mean, correlated between neighbouring cells.

    A cell shares some of its noise with the next one: 4.1 looks and a correlation of 0.19.
    """

    def __init__(self, seed: int) -> None:
        self._generator = stream(seed, "speckle")

    def on(self, power: Array) -> Array:
        """Return the power (b, bins) with speckle."""
        beams, bins = power.shape
        looks = self._generator.standard_gamma(_LOOKS, (beams, bins + 1), dtype=np.float32)
        shared = looks[:, :-1] + np.float32(_NEIGHBOUR) * looks[:, 1:]
        return power * shared / (_LOOKS * (1.0 + _NEIGHBOUR))
