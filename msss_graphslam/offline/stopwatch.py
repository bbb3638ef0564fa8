# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What a run costs: time by stage, CPU, memory."""

import resource
import time
from collections import defaultdict
from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np

from msss_graphslam.results.record import Cost

__all__ = ["Stopwatch"]


class Stopwatch:
    """Runs from its making until ``cost`` is asked for; ``stage`` times what it encloses."""

    def __init__(self) -> None:
        self._wall = time.perf_counter()
        self._cpu = time.process_time()
        self._stages: defaultdict[str, list[float]] = defaultdict(list)

    @contextmanager
    def stage(self, name: str) -> Iterator[None]:
        """Time one call of the named stage."""
        start = time.perf_counter()
        try:
            yield
        finally:
            self._stages[name].append(time.perf_counter() - start)

    @property
    def cost(self) -> Cost:
        """What it has cost so far."""
        return Cost(
            wall=time.perf_counter() - self._wall,
            cpu=time.process_time() - self._cpu,
            peak_rss_mib=resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0,
            stages={name: np.array(times) for name, times in self._stages.items()},
        )
