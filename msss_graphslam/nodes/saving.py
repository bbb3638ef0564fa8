# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The files of a live run: what ``msss run`` writes, from what the back end has."""

from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Self

from msss_graphslam.core.types import Beam, Estimate, Trajectory
from msss_graphslam.errors import UserError
from msss_graphslam.evaluation.assessment import assess
from msss_graphslam.evaluation.report import write_report
from msss_graphslam.evaluation.summary import summarise
from msss_graphslam.nodes.live_run import LiveRun, Maps
from msss_graphslam.offline.beside import Beside
from msss_graphslam.offline.drawing import Drawing
from msss_graphslam.offline.stopwatch import Stopwatch
from msss_graphslam.offline.writing import command_line, example_beams, record_of
from msss_graphslam.recordings.reader import Recording, open_recording
from msss_graphslam.results.directory import ResultDirectory
from msss_graphslam.results.record import Cost, RunRecord

__all__ = ["Source", "save"]

_NOT_ONLINE = "/pose: nothing came; dead reckoning stands for what was known online"


@dataclass(frozen=True, slots=True)
class Source:
    """The bag that was replayed, if any; only the evaluation looks into it."""

    recording: Recording | None = None
    truth: Trajectory | None = None
    refused: Counter[str] = field(default_factory=Counter)

    @classmethod
    def of(cls, path: str, complain: Callable[[str], object]) -> Self:
        """Read what is needed; without it the results are worth writing all the same."""
        refused: Counter[str] = Counter()
        try:
            if not path:
                return cls()
            recording = open_recording(Path(path))
            return cls(recording, recording.ground_truth(refused), refused)
        except UserError as error:
            complain(f"{error}; the report goes without it")
            return cls()


def save(
    result: Estimate,
    run: LiveRun,
    source: Source,
    output: Path,
    progress: Callable[[float, str], object],
) -> Maps:
    """Write all files; return the maps. Raises UserError where there is nothing to write.

    ``progress`` takes the finished share and what is being done.
    """
    if not len(result.trajectory.stamps_ns):
        raise UserError("no scan has come in")
    directory = ResultDirectory.create(output)
    progress(0.0, "maps")
    result, lack = _with_online(result)
    trajectories = Beside(partial(directory.write_trajectories, result))
    record = _record(result, run, source, lack)
    assessment = assess(record)
    drawing = Drawing(assessment)
    progress(0.4, "files")
    directory.write_graph_and_maps(record)
    trajectories.result()
    directory.write_summary(summarise(assessment))
    progress(0.7, "figures")
    write_report(directory, assessment, drawing.pictures())
    return record.points, record.grid


def _with_online(result: Estimate) -> tuple[Estimate, tuple[str, ...]]:
    """Return the estimate with what was known online, and what is to be said of that."""
    if len(result.online.stamps_ns):
        return result, ()
    # Without dead reckoning's node nobody had more than this.
    return replace(result, online=result.dead_reckoning), (_NOT_ONLINE,)


def _record(result: Estimate, run: LiveRun, source: Source, lack: tuple[str, ...]) -> RunRecord:
    recording, configuration = source.recording, run.configuration
    example: Callable[[], tuple[Beam, ...]] = tuple
    if recording is not None:
        example = Beside(partial(example_beams, recording, result, configuration)).result
    record = record_of(
        result,
        configuration,
        recording,
        run.refused + source.refused,
        run.beams,
        Stopwatch(),
        _command(run, recording),
        source.truth,
        example,
    )
    record = replace(record, bag=replace(record.bag, missing=(*record.bag.missing, *lack)))
    return replace(record, cost=_sum(run.cost, record.cost))


def _sum(before: Cost, after: Cost) -> Cost:
    """Return what both processes have cost; the larger one's memory stands for both."""
    return Cost(
        before.wall + after.wall,
        before.cpu + after.cpu,
        max(before.peak_rss_mib, after.peak_rss_mib),
        before.stages | after.stages,
    )


def _command(run: LiveRun, recording: Recording | None) -> str:
    words = ["msss", "live"]
    if recording is not None:
        words += ["--replay", recording.path.name]
    return command_line([*words, "--estimator", run.estimator], run.configuration)
