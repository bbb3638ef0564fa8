# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""From an estimate to the record of its run, and to the files of a directory."""

import shlex
from collections import Counter
from collections.abc import Callable, Sequence

from msss_graphslam import __version__
from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.maps.mapping import map_points, occupancy_grid
from msss_graphslam.core.types import Beam, Estimate, Trajectory
from msss_graphslam.evaluation.assessment import Assessment, assess
from msss_graphslam.evaluation.summary import summarise
from msss_graphslam.offline.stopwatch import Stopwatch
from msss_graphslam.recordings.inspection import lacks
from msss_graphslam.recordings.reader import Recording
from msss_graphslam.results.directory import ResultDirectory
from msss_graphslam.results.record import BagInfo, RunRecord, example_scan

__all__ = ["command_line", "example_beams", "record_of", "write_results"]


def command_line(words: Sequence[str], configuration: Configuration) -> str:
    """Return a command with all of the configuration that is not as it always is."""
    values = configuration.as_dict()
    changes: list[str] = []
    for info in Configuration.parameters():
        group, _, key = info.name.partition(".")
        if values[group][key] != info.default:
            changes += ["--set", f"{info.name}={values[group][key]}"]
    return shlex.join([*words, *changes])


def record_of(
    result: Estimate,
    configuration: Configuration,
    recording: Recording | None,
    refused: Counter[str],
    beams: int,
    watch: Stopwatch,
    command: str,
    truth: Trajectory | None,
    example: Callable[[], tuple[Beam, ...]] = tuple,
) -> RunRecord:
    """Return all that is known at the end of a run.

    Without a recording there is neither a truth nor an example of raw echoes. ``example`` gives
    that when all else is known.
    """
    with watch.stage("mapping"):
        points = map_points(result.keyframes)
        position = configuration.sonar.mount_position
        grid = occupancy_grid(result.keyframes, configuration.mapping, position)
    return RunRecord(
        estimate=result,
        points=points,
        grid=grid,
        truth=truth,
        beams=beams,
        refused=refused,
        configuration=configuration.as_dict(),
        bag=_bag_info(recording) if recording else _live_info(result),
        cost=watch.cost,
        version=__version__,
        command=command,
        example_beams=example(),
    )


def write_results(record: RunRecord, directory: ResultDirectory) -> Assessment:
    """Write the estimate and its summary; return the assessment for a report."""
    assessment = assess(record)
    directory.write_estimate(record)
    directory.write_summary(summarise(assessment))
    return assessment


def example_beams(
    recording: Recording, result: Estimate, configuration: Configuration
) -> tuple[Beam, ...]:
    """Return the recorded beams of the scan that a report shows."""
    number = example_scan(result)
    if number is None:
        return ()
    stamps = set(result.keyframes[number].scan.beam_stamps_ns.tolist())
    beams = recording.beams(min(stamps), max(stamps), configuration)
    return tuple(beam for beam in beams if beam.stamp_ns in stamps)


def _bag_info(recording: Recording) -> BagInfo:
    return BagInfo(
        name=recording.path.name,
        start_ns=recording.start_ns,
        end_ns=recording.end_ns,
        messages={name: topic.count for name, topic in recording.topics.items()},
        missing=tuple(f"{lack.name}: {lack.cost}" for lack in lacks(recording)),
        damage=(str(recording.damage),) if recording.damage else (),
    )


def _live_info(result: Estimate) -> BagInfo:
    stamps = result.trajectory.stamps_ns
    return BagInfo("live data", int(stamps[0]), int(stamps[-1]), messages={})
