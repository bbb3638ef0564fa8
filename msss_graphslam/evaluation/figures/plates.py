# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Which figures a report has, and how they become PNG files."""

import io
from collections.abc import Sequence

import matplotlib as mpl

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
from msss_graphslam.evaluation.pictures import DPI

__all__ = ["comparison_plates", "png", "run_plates"]

_NO_VERSION = {"Software": None}


def run_plates(assessment: Assessment) -> list[Plate]:
    """Draw the figures of one run; those for which the recording has no data are left out."""
    with mpl.rc_context(RC):
        plates = [
            trajectories([assessment]),
            maps([assessment]),
            occupancy(assessment),
            errors_over_time([assessment]) or corrections([assessment]),
            one_scan(assessment),
            echo_image(assessment),
            network(assessment),
            closures(assessment),
            uncertainty(assessment),
            timing(assessment),
        ]
    return [plate for plate in plates if plate is not None]


def comparison_plates(assessments: Sequence[Assessment]) -> list[Plate]:
    """Draw the figures that set several estimators of one recording side by side."""
    with mpl.rc_context(RC):
        return [
            trajectories(assessments),
            errors_over_time(assessments) or corrections(assessments),
            maps(assessments),
        ]


def png(plate: Plate) -> bytes:
    """Return the figure as a PNG file; equal figures make equal bytes."""
    image = io.BytesIO()
    with mpl.rc_context(RC):
        plate.figure.savefig(
            image, format="png", dpi=DPI, bbox_inches="tight", metadata=_NO_VERSION
        )
    return image.getvalue()
