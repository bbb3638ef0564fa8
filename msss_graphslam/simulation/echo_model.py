# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What an echo model is."""

from enum import StrEnum
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from msss_graphslam.simulation.scene import Pings

__all__ = ["EchoKind", "EchoModel"]


class EchoKind(StrEnum):
    """The echo models by name."""

    REAL = "real"
    IDEAL = "ideal"


class EchoModel(Protocol):
    """Makes the codes that the head sends; stateful, as its noise goes on from beam to beam."""

    def codes(self, pings: Pings) -> NDArray[np.uint8]:
        """Return the codes (b, bins) of consecutive beams."""
