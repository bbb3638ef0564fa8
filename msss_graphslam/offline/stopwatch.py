# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What a run costs: time by stage, CPU, memory."""

import resource
import time

import numpy as np

from msss_graphslam.results.record import Cost

__all__ = ["Stopwatch"]


class Stopwatch:
    """Runs from its making until ``cost`` is asked for; ``stage`` times what it encloses."""

    def __init__(self) -> None:
        self._wall = time.perf_counter()
        self._cpu = time.process_time()
        self._stages: dict[str, _Stage] = {}

    def stage(self, name: str) -> "_Stage":
        """Return what times one call of the named stage; a stage does not contain itself."""
        return self._stages.get(name) or self._stages.setdefault(name, _Stage())

    @property
    def cost(self) -> Cost:
        """What it has cost so far."""
        return Cost(
            wall=time.perf_counter() - self._wall,
            cpu=time.process_time() - self._cpu,
            peak_rss_mib=resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0,
            stages={name: np.array(stage.times) for name, stage in self._stages.items()},
        )


class _Stage:
    """The calls of one stage; entered a hundred thousand times, hence no generator."""

    def __init__(self) -> None:
        self.times: list[float] = []
        self._start = 0.0

    def __enter__(self) -> None:
        self._start = time.perf_counter()

    def __exit__(self, *_: object) -> None:
        self.times.append(time.perf_counter() - self._start)
