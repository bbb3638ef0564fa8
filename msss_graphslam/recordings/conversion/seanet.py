# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What recordings of SeaNet packets share."""

import re
from collections import Counter
from collections.abc import Mapping

from msss_graphslam.config.groups import Micron
from msss_graphslam.micron.reception import Reception

__all__ = ["count_refused", "reason_of", "reception"]


def reception(inverted: bool) -> Reception:
    """Return what makes beams of packets, with the default speeds of sound and of the line."""
    defaults = Micron()
    return Reception(defaults.sound_speed, inverted, defaults.baudrate)


def reason_of(text: str) -> str:
    """Return the reason of a refusal as one word."""
    return re.sub(r"[^a-z0-9]+", "_", text.lower()).strip("_")


def count_refused(refused: Mapping[str, int], refusals: Counter[str]) -> None:
    """Add what the packets' decoding refused."""
    for text, count in refused.items():
        refusals[reason_of(text)] += count
