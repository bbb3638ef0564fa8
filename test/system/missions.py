# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Short missions as bags, and what the offline run makes of them."""

import shutil
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.evaluation.assessment import assess
from msss_graphslam.evaluation.summary import summarise
from msss_graphslam.offline.estimation import estimate
from msss_graphslam.offline.estimators import recipe_named
from msss_graphslam.recordings.mcap_reading import RawMessage
from msss_graphslam.recordings.reader import open_recording
from msss_graphslam.recordings.writer import BagWriter
from msss_graphslam.results.directory import ResultDirectory
from msss_graphslam.simulation.path import Path as Course
from msss_graphslam.simulation.recording import simulate
from msss_graphslam.simulation.worlds import World, world_named

__all__ = ["SHARES", "Mission", "altered", "make_mission", "run_offline"]

SHARES = {"pond": 0.16, "paper": 0.1, "cave": 0.05}
"""How long the course is, as a share of the world's own."""

_BINS = 100
_STEP = np.radians(3.6)


@dataclass(frozen=True)
class Mission:
    """A bag, and the directory of what the offline run makes of it."""

    bag: Path
    offline: Path


def make_mission(name: str, folder: Path) -> Mission:
    """Simulate a short mission in the world, and run it offline, unless the folder has it."""
    if not folder.exists():
        unfinished = folder.with_suffix(".unfinished")
        shutil.rmtree(unfinished, ignore_errors=True)
        simulate(_small_world(name), 1, unfinished).bag.rename(unfinished / "bag")
        run_offline(unfinished / "bag", unfinished / "offline")
        unfinished.rename(folder)
    return Mission(folder / "bag", folder / "offline")


def altered(
    mission: Mission, bag: Path, change: Callable[[int, RawMessage], Iterable[RawMessage]]
) -> Mission:
    """Make a bag with what ``change(number, message)`` puts in place of every message."""
    with BagWriter(bag) as writer:
        for raw in _changed(open_recording(mission.bag).messages(), change):
            name = "" if raw.schema is None else raw.schema.name
            writer.write_raw(raw.channel.topic, name, raw.data, raw.log_ns, raw.publish_ns)
    return run_offline(bag, bag.with_name(f"{bag.name}_offline"))


def run_offline(bag: Path, output: Path) -> Mission:
    """Leave the files of ``msss run``, without the report."""
    recording = open_recording(bag)
    record = estimate(recording, recipe_named("full"), Configuration(), lambda *_: None)
    directory = ResultDirectory.create(output)
    directory.write_estimate(record)
    directory.write_summary(summarise(assess(record)))
    return Mission(bag, output)


def _small_world(name: str) -> World:
    """Return the world with a short course in it, seen coarsely."""
    world = world_named(name)
    waypoints = SHARES[name] * world.path.points[::100]
    return replace(
        world,
        path=Course.through(waypoints - waypoints[0]),
        laps=1,
        sonar=replace(world.sonar, bins=_BINS, step=_STEP),
    )


def _changed(
    messages: Iterable[RawMessage], change: Callable[[int, RawMessage], Iterable[RawMessage]]
) -> Iterator[RawMessage]:
    for number, raw in enumerate(messages):
        yield from change(number, raw)
