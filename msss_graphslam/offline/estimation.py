# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""One recording through one estimator: the part of a run that writes nothing."""

import shlex
from collections import Counter
from collections.abc import Callable

import numpy as np

from msss_graphslam import __version__
from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.mapping import map_points, occupancy_grid
from msss_graphslam.core.pipeline import Pipeline
from msss_graphslam.core.recipes import ESTIMATORS, Recipe
from msss_graphslam.core.types import Beam, Estimate
from msss_graphslam.errors import UserError
from msss_graphslam.offline.stopwatch import Stopwatch
from msss_graphslam.recordings.inspection import lacks
from msss_graphslam.recordings.reader import Recording
from msss_graphslam.results.record import BagInfo, RunRecord, example_scan

__all__ = ["Progress", "estimate", "recipe_named"]

Progress = Callable[[float, str], None]
"""Takes the finished fraction, 0 to 1, and what is being done."""

READING, REFINING = 0.75, 0.2
"""Shares of a run, as its progress shows them; maps and report are the rest."""

REPORT_EVERY = 500


def recipe_named(name: str) -> Recipe:
    """Return the estimator; UserError for an unknown name."""
    if name not in ESTIMATORS:
        raise UserError(f"unknown estimator {name!r}; choose one of {', '.join(ESTIMATORS)}")
    return ESTIMATORS[name]


def estimate(
    recording: Recording, recipe: Recipe, configuration: Configuration, progress: Progress
) -> RunRecord:
    """Run the estimator over the recording and return all that is known at the end.

    Raises UserError where the recording has no usable beam.
    """
    watch = Stopwatch()
    command = _command(recording, recipe, configuration)
    configuration = _with_mounting(recording, configuration)
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
    result = pipeline.finish(lambda share: progress(READING + REFINING * share, "refinement"))
    progress(READING + REFINING, "maps")
    with watch.stage("mapping"):
        points = map_points(result.keyframes)
        mount = np.array([configuration.sonar.mount_x, configuration.sonar.mount_y])
        grid = occupancy_grid(result.keyframes, configuration.mapping, mount)
    return RunRecord(
        estimate=result,
        points=points,
        grid=grid,
        truth=recording.ground_truth(refused),
        beams=beams,
        refused=refused,
        configuration=configuration.as_dict(),
        bag=_bag_info(recording),
        cost=watch.cost,
        version=__version__,
        command=command,
        example_beams=_example_beams(recording, result),
    )


def _command(recording: Recording, recipe: Recipe, configuration: Configuration) -> str:
    """Return the command that makes these results again, from where the bag lies."""
    values = configuration.as_dict()
    words = ["msss", "run", recording.path.name, "--estimator", recipe.name]
    for info in Configuration.parameters():
        group, _, key = info.name.partition(".")
        if values[group][key] != info.default:
            words += ["--set", f"{info.name}={values[group][key]}"]
    return shlex.join(words)


def _with_mounting(recording: Recording, configuration: Configuration) -> Configuration:
    """Return the configuration with the bag's mounting of the head, unless it has its own."""
    mounting = recording.mounting()
    if mounting is None:
        return configuration
    default = {info.name: info.default for info in Configuration.parameters()}
    sonar = configuration.as_dict()["sonar"]
    recorded = {
        name: value
        for name, value in mounting.parameters.items()
        if sonar[name.partition(".")[2]] == default[name]
    }
    return configuration.with_values(recorded)


def _share(recording: Recording, stamp_ns: int) -> float:
    span = max(recording.end_ns - recording.start_ns, 1)
    return float(np.clip((stamp_ns - recording.start_ns) / span, 0.0, 1.0))


def _bag_info(recording: Recording) -> BagInfo:
    return BagInfo(
        name=recording.path.name,
        start_ns=recording.start_ns,
        end_ns=recording.end_ns,
        messages={name: topic.count for name, topic in recording.topics.items()},
        missing=tuple(f"{lack.name}: {lack.cost}" for lack in lacks(recording)),
        damage=(str(recording.damage),) if recording.damage else (),
    )


def _example_beams(recording: Recording, result: Estimate) -> tuple[Beam, ...]:
    number = example_scan(result)
    if number is None:
        return ()
    stamps = set(result.keyframes[number].scan.beam_stamps_ns.tolist())
    return tuple(
        beam for beam in recording.beams(min(stamps), max(stamps)) if beam.stamp_ns in stamps
    )
