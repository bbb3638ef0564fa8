# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The figures of a report as files; what draws them is loaded only then."""

from collections.abc import Sequence
from dataclasses import dataclass

from msss_graphslam.evaluation.assessment import Assessment

__all__ = ["DPI", "Picture", "comparison_pictures", "picture_count", "run_picture", "run_pictures"]

DPI = 150


@dataclass(frozen=True, slots=True)
class Picture:
    """A figure's name, title and caption, and its PNG file's ``content``."""

    name: str
    title: str
    caption: str
    content: bytes

    @property
    def width(self) -> int:
        """Its width in pixels."""
        return int.from_bytes(self.content[16:20])


def run_pictures(assessment: Assessment) -> list[Picture]:
    """Draw the figures of one run."""
    drawn = [run_picture(assessment, number) for number in range(picture_count())]
    return [picture for picture in drawn if picture is not None]


def picture_count() -> int:
    """Return how many figures of one run there are at most."""
    from msss_graphslam.evaluation.figures.plates import PLATES

    return PLATES


def run_picture(assessment: Assessment, number: int) -> Picture | None:
    """Draw one of the figures of one run, None where the recording has no data for it."""
    from msss_graphslam.evaluation.figures.plates import png, run_plate

    plate = run_plate(assessment, number)
    if plate is None:
        return None
    return Picture(plate.name, plate.title, plate.caption, png(plate, DPI))


def comparison_pictures(assessments: Sequence[Assessment]) -> list[Picture]:
    """Draw the figures of several estimators' runs of one recording."""
    from msss_graphslam.evaluation.figures.plates import comparison_plates, png

    plates = comparison_plates(assessments)
    return [Picture(plate.name, plate.title, plate.caption, png(plate, DPI)) for plate in plates]
