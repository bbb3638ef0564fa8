# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The files of a live run: what ``msss run`` writes, from what the back end has."""

from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.recipes import Recipe
from msss_graphslam.core.types import Estimate
from msss_graphslam.errors import UserError
from msss_graphslam.evaluation.assessment import assess
from msss_graphslam.evaluation.report import write_report
from msss_graphslam.offline.drawing import Drawing
from msss_graphslam.offline.stopwatch import Stopwatch
from msss_graphslam.offline.writing import command_line, record_of, write_assessed
from msss_graphslam.recordings.reader import Recording, open_recording
from msss_graphslam.results.directory import ResultDirectory
from msss_graphslam.results.record import RunRecord

__all__ = ["LiveRun", "opened", "save"]

_NOT_ONLINE = "/pose: nothing came; dead reckoning stands for what was known online"


@dataclass(frozen=True, slots=True)
class LiveRun:
    """What is known of a live run beside its estimate.

    ``recording`` is the bag that was replayed, if any; only the evaluation looks into it.
    """

    configuration: Configuration
    recipe: Recipe
    refused: Counter[str]
    beams: int
    watch: Stopwatch
    recording: Recording | None = None


def opened(path: str, complain: Callable[[str], object]) -> Recording | None:
    """Return the recording; without it the results are worth writing all the same."""
    try:
        return open_recording(Path(path)) if path else None
    except UserError as error:
        complain(f"{error}; the report goes without it")
        return None


def save(result: Estimate, run: LiveRun, output: Path, drawing: Drawing) -> RunRecord:
    """Write all files; return the record. Raises UserError where there is nothing to write."""
    if not len(result.trajectory.stamps_ns):
        raise UserError("no scan has come in")
    directory = ResultDirectory.create(output)
    was_online = len(result.online.stamps_ns) > 0
    record = record_of(
        # Without dead reckoning's node nobody had more than this.
        result if was_online else replace(result, online=result.dead_reckoning),
        run.configuration,
        run.recording,
        run.refused.copy(),
        run.beams,
        run.watch,
        _command(run),
    )
    if not was_online:
        missing = (*record.bag.missing, _NOT_ONLINE)
        record = replace(record, bag=replace(record.bag, missing=missing))
    assessment = assess(record)
    drawing.begin(assessment)
    write_assessed(assessment, directory)
    write_report(directory, assessment, drawing.pictures())
    return record


def _command(run: LiveRun) -> str:
    words = ["msss", "live"]
    if run.recording is not None:
        words += ["--replay", run.recording.path.name]
    return command_line([*words, "--estimator", run.recipe.name], run.configuration)
