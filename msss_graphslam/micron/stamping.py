# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""When a beam was transmitted, judged by when its reply arrived.

A reply cannot arrive before the head has sent it, only later: operating systems, USB adapters and
serial servers hold bytes back. So the receipt less the reply's own time is a bound from above, and
the head's regular steps tell which receipts came late.
"""

from collections import Counter, deque
from collections.abc import Sequence

from msss_graphslam.micron.packets import TURN, HeadData
from msss_graphslam.micron.timing import STEP_ANGLE, beam_period, listening_time, reply_delay

__all__ = ["TransmitClock"]

_WINDOW = 8  # beams; what all of them are late by is no delay of the line
_GAP = 3.0  # modelled periods; a receipt later than this is a pause of the head,
_LONGEST_GAP_NS = 150_000_000  # and so is one later than this
_LOST = 8  # beams lost in a row; more steps than these are a jump of the head
_ANOTHER = 0.05  # share by which the modelled period of other settings differs
_MEMORY = 32  # beams over which the period is taken, beside
_PRIOR = 4  # beams of the period that was expected
_PERIOD_RANGE = 0.5, 1.5  # of the modelled period
_SHORTEST = 0.125  # periods; stamps are at least this far apart
_MOST_AHEAD_NS = 1_000_000_000  # stamps further before their receipts are given up


class TransmitClock:
    """Stamps of a stream of beams; ``restarts`` counts, by reason, when it had to start anew."""

    def __init__(self, baudrate: int) -> None:
        self._baudrate = baudrate
        self._last: HeadData | None = None
        self._received_ns = self._stamp_ns = 0
        self._model = self._expected = self._period = 1.0  # [ns]
        self._steps = 0
        self._observed: deque[tuple[int, int]] = deque(maxlen=_MEMORY + 1)  # steps, bound [ns]
        self._late: deque[float] = deque(maxlen=_WINDOW)
        self.restarts: Counter[str] = Counter()

    @property
    def period(self) -> float:
        """The time [s] between two beams as observed; 0 before the first."""
        return 0.0 if self._last is None else self._period * 1e-9

    def stamp(self, received_ns: int, beam: HeadData) -> int:
        """Return the time of transmission [ns] of a beam that arrived at ``received_ns``."""
        return self.stamp_all(received_ns, [beam])[0]

    def stamp_all(self, received_ns: int, beams: Sequence[HeadData]) -> list[int]:
        """Return the times of transmission [ns] of beams that arrived in one piece.

        Only the last of them can have arrived just then, each other one a beam's time before the
        next. The stamps rise, unless the receipts themselves fall back.
        """
        latest = self._latest_transmissions(received_ns, beams)
        return [self._stamp(received_ns, *pair) for pair in zip(latest, beams, strict=True)]

    def _latest_transmissions(self, received_ns: int, beams: Sequence[HeadData]) -> list[int]:
        """Return the bounds from above for the beams of one piece [ns]."""
        latest = []
        following = 0.0
        for i in reversed(range(len(beams))):
            delay = 1e9 * reply_delay(beams[i], self._baudrate)
            latest.append(received_ns - round(following + delay))
            if i:
                following += _steps(beams[i - 1], beams[i]) * self._expected_period(beams[i])
        return latest[::-1]

    def _stamp(self, received_ns: int, latest_ns: int, beam: HeadData) -> int:
        reason = self._reason_to_start(received_ns, latest_ns, beam)
        if reason:
            self.restarts[reason] += 1
            self._start(latest_ns, beam)
        else:
            self._follow(latest_ns, beam)
        self._last, self._received_ns = beam, received_ns
        return self._stamp_ns

    def _reason_to_start(self, received_ns: int, latest_ns: int, beam: HeadData) -> str:
        if self._last is None:
            return "first_beam"
        if self._is_other(self.modelled(beam)):
            return "other_settings"
        steps = _steps(self._last, beam)
        if steps > _LOST:
            return "bearing_jump"
        gap = min(_GAP * self._model, _LONGEST_GAP_NS)
        if received_ns < self._received_ns - gap:
            return "clock_set_back"
        if latest_ns - self._stamp_ns - steps * self._period > gap:
            return "pause"
        return "stamps_ahead" if self._stamp_ns - latest_ns > _MOST_AHEAD_NS else ""

    def _start(self, latest_ns: int, beam: HeadData) -> None:
        model = self.modelled(beam)
        if self._last is None or self._is_other(model):
            self._model = self._period = model
        self._expected, self._steps = self._period, 0
        self._late.clear()
        self._observed.clear()
        self._observed.append((0, latest_ns))
        self._stamp_ns = latest_ns

    def _follow(self, latest_ns: int, beam: HeadData) -> None:
        """Take the line through the earliest of the receipts, with the observed period."""
        steps = _steps(self._last, beam) if self._last else 1
        self._observe(steps, latest_ns)
        predicted = steps * self._period  # since the last stamp, where floats are exact enough
        self._late.append(latest_ns - self._stamp_ns - predicted)
        least = min(self._late)
        shift = least if least < 0.0 or len(self._late) == _WINDOW else 0.0
        elapsed = max(predicted + shift, _SHORTEST * self._period)
        self._late = deque((late - (elapsed - predicted) for late in self._late), maxlen=_WINDOW)
        self._stamp_ns += round(elapsed)

    def _observe(self, steps: int, latest_ns: int) -> None:
        """Take the period from the receipts; delays come and go, and leave its mean alone."""
        self._steps += steps
        self._observed.append((self._steps, latest_ns))
        first_step, first_ns = self._observed[0]
        span = latest_ns - first_ns + _PRIOR * self._expected
        period = span / (self._steps - first_step + _PRIOR)
        shortest, longest = (share * self._model for share in _PERIOD_RANGE)
        self._period = min(max(period, shortest), longest)

    def modelled(self, beam: HeadData) -> float:
        """Return the time [ns] that such a beam takes by the protocol's timing."""
        listening = listening_time(beam.ad_interval, beam.bins)
        return 1e9 * beam_period(listening, beam.step * STEP_ANGLE, len(beam.data), self._baudrate)

    def _is_other(self, model: float) -> bool:
        return abs(model - self._model) > _ANOTHER * self._model

    def _expected_period(self, beam: HeadData) -> float:
        model = self.modelled(beam)
        return model if self._last is None or self._is_other(model) else self._period


def _steps(before: HeadData, beam: HeadData) -> int:
    """Return how many steps the head has made between the two, at least one."""
    turned = abs(beam.bearing - before.bearing)
    return max(1, round(min(turned, TURN - turned) / max(beam.step, 1)))
