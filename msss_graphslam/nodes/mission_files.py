# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""From a mission to the files of its result."""

from collections.abc import Callable
from pathlib import Path

from msss_graphslam.core.types import Estimate
from msss_graphslam.nodes.live_run import LiveRun, Maps
from msss_graphslam.nodes.mission import Mission
from msss_graphslam.nodes.saving_process import SavingProcess
from msss_graphslam.nodes.tenths import Tenths

__all__ = ["MissionFiles"]

_SMOOTHING = 0.5
"""Share of joint smoothing in the whole, as the log tells it."""


class MissionFiles:
    """Writes into ``output``; what it does stands in the log.

    ``recording`` is the bag that is replayed, '' for none; ``complain`` is told where it cannot
    be used.
    """

    def __init__(
        self,
        output: Path,
        recording: str,
        log: Callable[[str], object],
        complain: Callable[[str], object],
    ) -> None:
        self._output = output
        self._recording = recording
        self._complain = complain
        self._tell = Tenths(log)

    def write(self, mission: Mission, run_so_far: Callable[[], LiveRun]) -> tuple[Estimate, Maps]:
        """Smooth a copy of the mission and write all files; return the estimate and the maps.

        Raises UserError where that cannot be. ``run_so_far`` is asked when it is smoothed.
        """
        # What writes makes ready meanwhile.
        with SavingProcess(self._recording, self._complain) as saving:
            estimate = mission.logbook().finish(self._smoothed)
            return estimate, saving.save(estimate, run_so_far(), self._output, self._written)

    def _smoothed(self, share: float) -> None:
        self._tell(_SMOOTHING * share, "joint smoothing")

    def _written(self, share: float, what: str) -> None:
        self._tell(_SMOOTHING + (1.0 - _SMOOTHING) * share, what)
