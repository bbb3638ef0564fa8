# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""``msss inspect``: what is in a bag, and what is missing to run it."""

from argparse import ArgumentParser, Namespace
from collections.abc import Iterator
from math import degrees

from msss_graphslam.cli.console import Console, Row
from msss_graphslam.cli.exit_codes import ExitCode
from msss_graphslam.cli.options import add_bag, add_configuration, configuration_of
from msss_graphslam.recordings.inspection import InspectionReport, TopicReport, inspect
from msss_graphslam.recordings.sonar_settings import SonarSettings

__all__ = ["SUMMARY", "add_arguments", "execute"]

SUMMARY = "show what is in a bag, and what is missing to run it"


def add_arguments(parser: ArgumentParser) -> None:
    """Add the command's arguments."""
    add_bag(parser)
    add_configuration(parser)


def execute(arguments: Namespace, console: Console) -> ExitCode:
    """Print the topics with rates and gaps, and what is missing."""
    report = inspect(arguments.bag, configuration_of(arguments))
    console.result(report.as_dict(), lambda: _show(console, report))
    return console.lost(_lost(report)) if report.can_run else _refuse(console, report)


def _show(console: Console, report: InspectionReport) -> None:
    header = ("topic", "type", "messages", "rate [Hz]", "gaps", "longest gap")
    console.line(f"{report.path}: {report.duration:.1f} s")
    console.table(header, [_topic_row(topic) for topic in report.topics])
    if report.sonar is not None:
        console.line(f"{_head(report.sonar)}, from {report.sonar_topic}")
    for line in _missing(report):
        console.line(line)


def _topic_row(topic: TopicReport) -> Row:
    gaps = [f"{gap.duration:.2f} s after {gap.start:.1f} s" for gap in topic.longest_gaps]
    return (
        topic.name,
        topic.type_name,
        str(topic.count),
        "" if topic.rate is None else f"{topic.rate:.2f}",
        str(topic.gap_count),
        gaps[0] if gaps else "",
    )


def _head(sonar: SonarSettings) -> str:
    turn = "" if sonar.turn_time is None else f", {sonar.turn_time:.2f} s a turn"
    return (
        f"sonar: {sonar.beams} beams of {sonar.bins} bins to {sonar.maximum_range:.2f} m"
        f" ({100.0 * sonar.bin_length:.1f} cm a bin), {degrees(sonar.step):.2f} deg a step,"
        f" {sonar.direction}{turn}, {sonar.turns:.1f} turns"
    )


def _missing(report: InspectionReport) -> Iterator[str]:
    if not report.lacks:
        yield "nothing is missing"
    for lack in report.lacks:
        yield f"missing {lack.name}: {lack.cost}"


def _lost(report: InspectionReport) -> str:
    refused = [f"{count} x {reason}" for reason, count in report.refused.items()]
    return "; ".join(refused + [str(report.damage)] * bool(report.damage))


def _refuse(console: Console, report: InspectionReport) -> ExitCode:
    console.error(f"msss: cannot be run: {report.problem}")
    return ExitCode.CANNOT_GO_ON
