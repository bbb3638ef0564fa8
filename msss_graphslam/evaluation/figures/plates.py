# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Which figures a report has, and how they become PNG files."""

import io
from collections.abc import Callable, Sequence

import matplotlib as mpl
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.image import imsave
from numpy.typing import NDArray

from msss_graphslam.evaluation.assessment import Assessment
from msss_graphslam.evaluation.figures.closures import closures
from msss_graphslam.evaluation.figures.echo_image import echo_image
from msss_graphslam.evaluation.figures.errors import corrections, errors_over_time
from msss_graphslam.evaluation.figures.maps import maps, occupancy
from msss_graphslam.evaluation.figures.network import network
from msss_graphslam.evaluation.figures.scan import one_scan
from msss_graphslam.evaluation.figures.style import RC, Plate
from msss_graphslam.evaluation.figures.timing import timing
from msss_graphslam.evaluation.figures.trajectories import trajectories
from msss_graphslam.evaluation.figures.uncertainty import uncertainty

__all__ = ["PLATES", "comparison_plates", "png", "run_plate", "run_plates"]

_MARGIN = 0.1
_COMPRESSION = 3
"""More takes twice the time and saves a tenth of the file."""

_RUN: tuple[Callable[[Assessment], Plate | None], ...] = (
    lambda run: trajectories([run]),
    lambda run: maps([run]),
    occupancy,
    lambda run: errors_over_time([run]) or corrections([run]),
    one_scan,
    echo_image,
    network,
    closures,
    uncertainty,
    timing,
)

PLATES = len(_RUN)
"""How many figures of one run there are at most."""


def run_plates(assessment: Assessment) -> list[Plate]:
    """Draw the figures of one run; those for which the recording has no data are left out."""
    plates = [run_plate(assessment, number) for number in range(PLATES)]
    return [plate for plate in plates if plate is not None]


def run_plate(assessment: Assessment, number: int) -> Plate | None:
    """Draw one of the figures of one run, None where the recording has no data for it."""
    with mpl.rc_context(RC):
        return _RUN[number](assessment)


def comparison_plates(assessments: Sequence[Assessment]) -> list[Plate]:
    """Draw the figures that set several estimators of one recording side by side."""
    with mpl.rc_context(RC):
        return [
            trajectories(assessments),
            errors_over_time(assessments) or corrections(assessments),
            maps(assessments),
        ]


def png(plate: Plate, dpi: int) -> bytes:
    """Return the figure as a PNG file of so many dots per inch; equal figures, equal bytes."""
    # Matplotlib's own tight box lays a figure out and goes through all of it once more.
    with mpl.rc_context(RC):
        plate.figure.set_dpi(dpi)
        canvas = FigureCanvasAgg(plate.figure)
        canvas.draw()  # type: ignore[no-untyped-call]
        drawn = np.asarray(canvas.buffer_rgba())  # type: ignore[no-untyped-call]
    image = io.BytesIO()
    imsave(
        image,
        _cropped(drawn, round(_MARGIN * dpi)),
        format="png",
        dpi=dpi,
        metadata={"Software": None},  # type: ignore[dict-item]
        pil_kwargs={"compress_level": _COMPRESSION},
    )
    return image.getvalue()


def _cropped(pixels: NDArray[np.uint8], margin: int) -> NDArray[np.uint8]:
    """Return the pixels (h, w, 4) within the background, with as much margin on every side."""
    whole = pixels.view(np.uint32)[..., 0]
    background = whole[0, 0]
    drawn = whole != background
    rows, columns = (np.flatnonzero(drawn.any(axis=axis)) for axis in (1, 0))
    if not len(rows):
        return pixels
    inner = whole[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]
    outer = np.pad(inner, margin, constant_values=background)
    return outer[..., None].view(np.uint8)
