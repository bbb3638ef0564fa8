# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""How every figure looks."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from msss_graphslam.core.types import Array
from msss_graphslam.evaluation.wording import ACCENT, colour, label, phrase

__all__ = [
    "ACCENT",
    "MAP",
    "MUTED",
    "RC",
    "REFUSALS",
    "TRUTH",
    "Plate",
    "colour",
    "label",
    "minutes",
    "phrase",
]

TRUTH, MAP, MUTED = "#111111", "#76838f", "#5b6672"
REFUSALS = ("#d55e00", "#cc79a7", "#e69f00", "#56b4e9", "#009e73")
RC: dict[Any, Any] = {
    "figure.dpi": 150,
    "font.family": "DejaVu Sans",
    "font.size": 9.0,
    "axes.titlesize": 10.0,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.labelcolor": "#333a42",
    "axes.edgecolor": "#b5bdc6",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": "#e4e8ec",
    "grid.linewidth": 0.7,
    "xtick.color": MUTED,
    "ytick.color": MUTED,
    "legend.frameon": False,
    "legend.fontsize": 8.5,
    "legend.title_fontsize": 10.0,
    "lines.solid_capstyle": "round",
}


@dataclass(frozen=True, slots=True)
class Plate:
    """A drawn figure, its file's name, its title and a caption that a person understands."""

    name: str
    title: str
    caption: str
    figure: Figure


def minutes(stamps_ns: Array | np.ndarray, start_ns: int) -> Array:
    """Return the time since the start [min]."""
    return np.asarray((np.asarray(stamps_ns) - start_ns) / 60e9)
