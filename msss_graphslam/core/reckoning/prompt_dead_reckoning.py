# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Dead reckoning twice over: an answer at once, and one in which late data have their place."""

from collections import Counter
from dataclasses import dataclass

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.config.groups import DeadReckoning as DeadReckoningConfig
from msss_graphslam.core.reckoning.dead_reckoning import DeadReckoning
from msss_graphslam.core.reckoning.sequencing import Sequencer
from msss_graphslam.core.types import Array, Measurement, Odometry

__all__ = ["Answer", "PromptDeadReckoning"]

_FORK_PERIOD_NS = 1_000_000_000


@dataclass(frozen=True, slots=True)
class Answer:
    """What one measurement brings: ``settled`` odometry in order, and the ``prompt`` one.

    ``prompt`` is None where the measurement brings none that is newer than the last.
    """

    settled: list[Odometry]
    prompt: Odometry | None


class PromptDeadReckoning:
    """One filter over measurements in the order of their stamps, and a fork of it up to now.

    The settled odometry depends on the stamps alone; scans are made from it. The prompt one comes
    with each measurement and is what a controller needs; it takes data in the order in which they
    come, and within a second in the order of their stamps.
    """

    def __init__(self, configuration: Configuration, refused: Counter[str]) -> None:
        sensors = configuration.sensors
        self._sequencer = Sequencer(sensors.reorder_window, sensors.patience, refused)
        self._settled = DeadReckoning(configuration.dead_reckoning, refused)
        self._ahead = self._settled.fork(Counter())
        self._is_disordered = False
        self._newest_ns = self._forked_ns = self._published_ns = -(2**62)

    def resume(self, stamp_ns: int, pose: Array) -> None:
        """Go on from an earlier ``pose`` (6,) in ``odom``, before the first measurement."""
        self._settled.resume(stamp_ns, pose)
        self._ahead = self._settled.fork(Counter())

    def configure(self, config: DeadReckoningConfig) -> None:
        """Go on with other parameters."""
        self._settled.configure(config)
        self._ahead.configure(config)

    @property
    def held(self) -> int:
        """How many measurements wait for their turn."""
        return len(self._sequencer.held())

    def process(self, measurement: Measurement) -> Answer:
        """Take in the next measurement in the order of arrival."""
        if not self._sequencer.admits(measurement):
            return Answer(self._settle(self._sequencer.push(measurement)), None)
        settled = self._settle(self._sequencer.push(measurement))
        self._is_disordered |= measurement.stamp_ns < self._newest_ns
        self._newest_ns = max(self._newest_ns, measurement.stamp_ns)
        prompt = self._ahead.process(measurement)
        if self._is_disordered and self._newest_ns - self._forked_ns > _FORK_PERIOD_NS:
            prompt = self._catch_up()
        return Answer(settled, self._newer(prompt))

    @property
    def reached_ns(self) -> int | None:
        """Newest stamp of the sensor that speaks most often, None before the first."""
        return self._sequencer.reached_ns

    def finish(self) -> list[Odometry]:
        """Work off what is held, and return its settled odometry."""
        return self._settle(self._sequencer.flush()) + self._settled.start()

    def _settle(self, measurements: list[Measurement]) -> list[Odometry]:
        return [entry for one in measurements for entry in self._settled.process(one)]

    def _catch_up(self) -> list[Odometry]:
        """Begin the fork anew where the settled filter stands, with all that is held."""
        self._is_disordered, self._forked_ns = False, self._newest_ns
        self._ahead = self._settled.fork(Counter())
        return [entry for one in self._sequencer.held() for entry in self._ahead.process(one)]

    def _newer(self, brought: list[Odometry]) -> Odometry | None:
        if not brought or brought[-1].stamp_ns <= self._published_ns:
            return None
        self._published_ns = brought[-1].stamp_ns
        return brought[-1]
