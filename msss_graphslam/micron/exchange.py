# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What is on its way to the head, how often it has been sent, and until when it is waited for."""

from collections import deque

from msss_graphslam.micron.packets import SendData
from msss_graphslam.micron.requests import Requests
from msss_graphslam.micron.stages import Stage

__all__ = ["Exchange"]

_DAY_MS = 86_400_000
_MOST_WAITING = 16  # packets to be written


class Exchange:
    """Packets for the head and the time of their answers, on the clock of ``see`` [ns]."""

    def __init__(self) -> None:
        self.requests = Requests()
        self._waiting: deque[bytes] = deque(maxlen=_MOST_WAITING)
        self._now_ns = self._begun_ns = self._deadline_ns = 0
        self._tries = 0

    @property
    def next_ns(self) -> int:
        """When there is something to be written, or no answer has come."""
        return self._now_ns if self._waiting else self._deadline_ns

    @property
    def age_ns(self) -> int:
        """How long ago the stage has begun."""
        return self._now_ns - self._begun_ns

    @property
    def is_overdue(self) -> bool:
        """Whether the time for an answer is over."""
        return self._now_ns >= self._deadline_ns

    def see(self, now_ns: int) -> None:
        """Follow the clock; where it was set back, what was waited for has not moved away."""
        back = self._now_ns - now_ns
        if back > 0:
            self._deadline_ns -= back
            self._begun_ns -= back
        self._now_ns = now_ns

    def begin(self, stage: Stage) -> None:
        """Have the stage's packet written for the first time."""
        self.renew(stage)
        self._begun_ns = self._now_ns
        self.send(stage)

    def renew(self, stage: Stage) -> None:
        """Take note that the head has answered: all tries are left."""
        self._tries = stage.tries

    def repeat(self, stage: Stage) -> bool:
        """Have the packet written once more, if a try is left; return whether one was."""
        self._tries -= 1
        if self._tries <= 0:
            return False
        self.send(stage)
        return True

    def send(self, stage: Stage) -> None:
        """Have the stage's packet written, and wait for an answer."""
        self.wait(stage.patience)
        match stage.request:
            case None:
                return
            case SendData():
                self.requests.asked()
                request = SendData(self._now_ns // 1_000_000 % _DAY_MS)
            case request:
                pass
        self._waiting.append(request.frame().encode())

    def wait(self, seconds: float) -> None:
        """Wait for so long from now on."""
        self._deadline_ns = self._now_ns + round(seconds * 1e9)

    def take(self) -> list[bytes]:
        """Return the packets to be written, once."""
        packets = list(self._waiting)
        self._waiting.clear()
        return packets
