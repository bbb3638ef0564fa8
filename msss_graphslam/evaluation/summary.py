# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The figures of summary.json and of the result table."""

from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

from msss_graphslam.core.types import SonarCalibration
from msss_graphslam.evaluation.assessment import Assessment
from msss_graphslam.evaluation.errors import PoseErrors, Statistics, start_end_gap

__all__ = ["summarise"]

_DIGITS = 6


def summarise(assessment: Assessment) -> dict[str, Any]:
    """Return the content of summary.json; the keys of errors are there only with a truth."""
    record = assessment.record
    summary: dict[str, Any] = {
        "duration_s": round(record.bag.duration, _DIGITS),
        "wall_s": round(record.cost.wall, _DIGITS),
        "cpu_s": round(record.cost.cpu, _DIGITS),
        "realtime_factor": round(record.realtime_factor, 3),
        "peak_rss_mib": round(record.cost.peak_rss_mib, 3),
        "beams": record.beams,
        "scans": len(record.estimate.keyframes),
        "loop_closures": {"tried": record.tried_loops, "accepted": record.accepted_loops},
        "refused": dict(sorted(record.refused.items())),
        "damage": list(record.bag.damage),
        "missing": list(record.bag.missing),
        "start_end_gap_m": {
            name: round(start_end_gap(trajectory), _DIGITS)
            for name, trajectory in assessment.trajectories.items()
        },
    }
    if assessment.errors:
        summary["position_error_m"] = _error_table(assessment.errors)
    if assessment.online_errors is not None:
        online = {assessment.estimator: assessment.online_errors}
        summary["online_position_error_m"] = _error_table(online)
    calibration = record.estimate.sonar_calibration
    if calibration is not None:
        summary["sonar_calibration"] = _calibration_table(calibration)
    summary["configuration"] = {"estimator": assessment.estimator, **record.configuration}
    return summary


def _calibration_table(calibration: SonarCalibration) -> dict[str, float]:
    yaw, scale = calibration.deviations
    figures = {
        "mount_yaw_rad": calibration.yaw,
        "mount_yaw_deviation_rad": yaw,
        "range_scale": calibration.scale,
        "range_scale_deviation": scale,
    }
    return {name: round(value, _DIGITS) for name, value in figures.items()}


def _error_table(errors: Mapping[str, PoseErrors]) -> dict[str, dict[str, float]]:
    return {name: _rounded(Statistics.of(entry.anchored)) for name, entry in errors.items()}


def _rounded(statistics: Statistics) -> dict[str, float]:
    return {name: round(value, _DIGITS) for name, value in asdict(statistics).items()}
