# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""report.html: one file that needs nothing else, with every figure and table in it."""

import base64
import datetime
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from jinja2 import Environment, PackageLoader, StrictUndefined, Template

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.evaluation.assessment import Assessment
from msss_graphslam.evaluation.headlines import headlines
from msss_graphslam.evaluation.pictures import DPI, Picture, comparison_pictures, run_pictures
from msss_graphslam.evaluation.result_table import result_table
from msss_graphslam.evaluation.wording import colour, phrase
from msss_graphslam.results.atomic import write_bytes
from msss_graphslam.results.directory import ResultDirectory
from msss_graphslam.results.record import BagInfo

__all__ = ["write_comparison_report", "write_report"]

_CSS_PIXELS_AN_INCH = 108


@dataclass(frozen=True, slots=True)
class _Embedded:
    title: str
    caption: str
    data: str
    width: int


def write_report(
    directory: ResultDirectory,
    assessment: Assessment,
    pictures: Sequence[Picture] | None = None,
) -> None:
    """Write figures/*.png and report.html of one run, whose ``pictures`` may be drawn already."""
    record = assessment.record
    _write(
        directory,
        [assessment],
        run_pictures(assessment) if pictures is None else pictures,
        title=f"Graph SLAM of {record.bag.name}",
        estimators=f"Estimator {phrase(assessment.estimator)}",
        timing=_timing_rows(assessment),
        refused=dict(record.refused.most_common()),
        consistency=assessment.keyframe_consistency,
    )


def write_comparison_report(directory: ResultDirectory, assessments: Sequence[Assessment]) -> None:
    """Write figures/*.png and report.html on several estimators' runs of one recording."""
    _write(
        directory,
        assessments,
        comparison_pictures(assessments),
        title=f"Estimators compared on {assessments[0].record.bag.name}",
        estimators=", ".join(phrase(run.estimator) for run in assessments),
        timing=[],
        refused={},
        consistency=None,
    )


def _write(
    directory: ResultDirectory,
    assessments: Sequence[Assessment],
    pictures: Sequence[Picture],
    **context: Any,
) -> None:
    record = assessments[-1].record
    html = _template().render(
        assessments=assessments,
        record=record,
        recorded=_recorded(record.bag),
        headlines=headlines(assessments),
        results=result_table(assessments),
        pictures=[_embedded(directory, picture) for picture in pictures],
        parameters=_parameters(record.configuration),
        **context,
    )
    directory.write_report(html)


def _template() -> Template:
    environment = Environment(
        loader=PackageLoader("msss_graphslam.evaluation"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["phrase"] = phrase
    environment.filters["colour"] = lambda name: colour(name.removesuffix(", online"))
    return environment.get_template("report.html.jinja")


def _embedded(directory: ResultDirectory, picture: Picture) -> _Embedded:
    """Save the figure, and return it as the report embeds it."""
    write_bytes(directory.figure_path(picture.name), picture.content)
    return _Embedded(
        picture.title,
        picture.caption,
        base64.b64encode(picture.content).decode(),
        round(picture.width / DPI * _CSS_PIXELS_AN_INCH),
    )


def _timing_rows(assessment: Assessment) -> list[dict[str, Any]]:
    """Return a row a stage: calls, total [s], and mean, median, 95 % and longest call [ms]."""
    return [
        {
            "stage": phrase(stage),
            "calls": len(times),
            "total": float(np.sum(times)),
            "milliseconds": [
                1e3 * float(value)
                for value in (np.mean(times), *np.quantile(times, [0.5, 0.95, 1.0]))
            ],
        }
        for stage, times in assessment.record.cost.stages.items()
        if len(times)
    ]


def _parameters(configuration: dict[str, dict[str, Any]]) -> list[dict[str, Any]]:
    """Return the resolved parameters; ``changed`` where the value is not the default."""
    rows = []
    for info in Configuration.parameters():
        group, _, key = info.name.partition(".")
        value = configuration[group][key]
        rows.append({"info": info, "value": value, "changed": value != info.default})
    return rows


def _recorded(bag: BagInfo) -> str:
    start = datetime.datetime.fromtimestamp(bag.start_ns * 1e-9, tz=datetime.UTC)
    return f"{start:%Y-%m-%d %H:%M:%S} UTC"
