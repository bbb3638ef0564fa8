# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Which measurements dead reckoning believes."""

from collections import Counter
from copy import copy
from typing import Self

from msss_graphslam.config.groups import DeadReckoning as DeadReckoningConfig
from msss_graphslam.core.reckoning.kalman_filter import KalmanFilter

__all__ = ["InnovationGate"]


class InnovationGate:
    """Admits what lies near its prediction; what is refused is counted in ``refused``.

    A sensor that is refused for too long opens its state instead.
    """

    def __init__(self, config: DeadReckoningConfig, refused: Counter[str]) -> None:
        self._refused = refused
        self._since: dict[str, int] = {}
        self.configure(config)

    def configure(self, config: DeadReckoningConfig) -> None:
        """Go on with other parameters."""
        self._squared = config.innovation_gate**2
        self._patience_ns = config.patience * 1e9

    def fork(self, refused: Counter[str]) -> Self:
        """Return one that has refused the same and goes its own way, counting elsewhere."""
        clone = copy(self)
        clone._refused, clone._since = refused, self._since.copy()
        return clone

    def admits(
        self,
        ekf: KalmanFilter,
        name: str,
        index: int,
        difference: float,
        variance: float,
        now_ns: int,
    ) -> bool:
        """Whether to take in ``difference``, measured with ``variance``, of a state."""
        if difference**2 <= self._squared * (ekf.spread(index) + variance):
            self._since.pop(name, None)
            return True
        self._refused[f"{name}_innovation"] += 1
        since = self._since.setdefault(name, now_ns)
        if now_ns - since < self._patience_ns:
            return False
        self._refused[f"{name}_reset"] += 1
        ekf.open(index, difference)
        self._since.pop(name, None)
        return True
