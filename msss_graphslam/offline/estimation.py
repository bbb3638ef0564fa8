# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""One recording through one estimator: the part of a run that writes nothing."""

from collections import Counter
from collections.abc import Callable
from functools import partial

import numpy as np

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.pipeline import Pipeline
from msss_graphslam.core.recipes import Recipe
from msss_graphslam.core.types import Beam
from msss_graphslam.errors import UserError
from msss_graphslam.offline.freed_memory import give_back
from msss_graphslam.offline.stopwatch import Stopwatch
from msss_graphslam.offline.writing import command_line, example_beams, record_of
from msss_graphslam.recordings.reader import Recording
from msss_graphslam.results.record import RunRecord

__all__ = ["Progress", "estimate"]

Progress = Callable[[float, str], None]
"""Takes the finished fraction, 0 to 1, and what is being done."""

READING, SMOOTHING = 0.75, 0.2
"""Shares of a run, as its progress shows them; maps and report are the rest."""

REPORT_EVERY = 500


def estimate(
    recording: Recording, recipe: Recipe, configuration: Configuration, progress: Progress
) -> RunRecord:
    """Run the estimator over the recording and return all that is known at the end.

    Raises UserError where the recording has no usable beam.
    """
    watch = Stopwatch()
    command = _command(recording, recipe, configuration)
    configuration = recording.completed(configuration)
    refused: Counter[str] = Counter()
    pipeline = Pipeline(configuration, recipe, refused, watch.stage)
    beams = 0
    for number, measurement in enumerate(recording.measurements(refused, configuration)):
        pipeline.process(measurement)
        beams += isinstance(measurement, Beam)
        if number % REPORT_EVERY == 0:
            progress(READING * _share(recording, measurement.stamp_ns), recipe.name)
    if not beams:
        reasons = ", ".join(f"{reason} {count}" for reason, count in refused.most_common())
        raise UserError(f"{recording.path}: no beam can be used ({reasons}); see `msss inspect`")
    result = pipeline.finish(partial(_smoothing, progress))
    progress(READING + SMOOTHING, "maps")
    truth = recording.ground_truth(refused)
    example = partial(example_beams, recording, result, configuration)
    return record_of(
        result, configuration, recording, refused, beams, watch, command, truth, example
    )


def _smoothing(progress: Progress, share: float) -> None:
    give_back()
    progress(READING + SMOOTHING * share, "joint smoothing")


def _command(recording: Recording, recipe: Recipe, configuration: Configuration) -> str:
    """Return the command that makes these results again, from where the bag lies."""
    words = ["msss", "run", recording.path.name, "--estimator", recipe.name]
    return command_line(words, configuration)


def _share(recording: Recording, stamp_ns: int) -> float:
    span = max(recording.end_ns - recording.start_ns, 1)
    return float(np.clip((stamp_ns - recording.start_ns) / span, 0.0, 1.0))
