# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The scanning part of a head: from parameters and requests to pings and replies."""

from dataclasses import dataclass, replace

from msss_graphslam.micron.packets import (
    GainsCommand,
    HeadCommand,
    HeadControl,
    HeadData,
    HeadStatus,
    ReverseScan,
)
from msss_graphslam.micron.timing import reply_delay, transfer_time
from msss_graphslam.simulation.emulator.programme import Programme, bearing_angle
from msss_graphslam.simulation.emulator.sending import nanoseconds
from msss_graphslam.simulation.emulator.turning import Turning
from msss_graphslam.simulation.emulator.view import Look

__all__ = ["Nature", "Scanner"]


@dataclass(frozen=True, slots=True)
class Nature:
    """What kind of head it is.

    A ``seaking`` is the older type, any other a DST; ``full_duplex`` heads send two beams for a
    request; ``fewer_bins`` is by how much a beam falls short of what was asked for; an
    ``inverted`` head hangs upside down, whether it is told so or not.
    """

    seaking: bool = False
    full_duplex: bool = True
    baudrate: int = 115200
    fewer_bins: int = 0
    inverted: bool = False

    @property
    def device_type(self) -> int:
        """How the head calls itself."""
        return 0x02 if self.seaking else 0x11

    @property
    def replies(self) -> int:
        """Beams that are sent for a request."""
        return 2 if self.full_duplex else 1


class Scanner:
    """Pings on request, at the pace of the motor, the sound and the line.

    Times are nanoseconds; ``launch_ns`` is when the vehicle set off.
    """

    def __init__(self, look: Look, nature: Nature, launch_ns: int) -> None:
        self._look = look
        self._nature = nature
        self._launch_ns = launch_ns
        self.restart()

    def restart(self) -> None:
        """Forget everything; the transducer points ahead."""
        self.programme: Programme | None = None
        self.turning = Turning(turns_early=self._nature.seaking)
        self._motor_lost = False
        self._owed = 0
        self._ready_ns = self._asked_ns = 0

    def lose_sync(self) -> None:
        """Lose the motor's position: replies say so until new parameters come."""
        self._motor_lost = True

    def take(self, command: HeadCommand | GainsCommand | ReverseScan, now_ns: int) -> bool:
        """Obey; return whether the command made sense."""
        if isinstance(command, HeadCommand):
            return self._begin(Programme.of(command, self._nature.fewer_bins), now_ns)
        if self.programme is None:
            return False
        if isinstance(command, ReverseScan):
            self.turning.clockwise = not self.turning.clockwise
        else:
            gains = command.gains
            self.programme = replace(
                self.programme,
                gain=gains.gain_1,
                ad_span=gains.ad_span_1,
                ad_low=gains.ad_low_1,
                slope=gains.slope_1,
            )
        return True

    def request(self, now_ns: int) -> bool:
        """Take a request for beams; return whether the head has parameters to scan by."""
        if self.programme is None:
            return False
        # The head pings ahead of the request, but does not send an echo that has grown old.
        if not self._owed and now_ns - self._ready_ns > self._period_ns(self.programme):
            self._ready_ns = now_ns
        self._owed = min(self._owed + self._nature.replies, 2 * self._nature.replies)
        self._asked_ns = now_ns
        return True

    @property
    def next_ns(self) -> int | None:
        """When the next ping is sent, or None while none is asked for."""
        return self._ready_ns if self._owed else None

    def ping(self) -> tuple[HeadData, int]:
        """Return the reply to the ping that is due, and when it can begin to be sent [ns]."""
        programme = self.programme
        if programme is None or not self._owed:
            raise ValueError("no ping is due")
        at_ns = self._ready_ns
        seconds = (at_ns - self._launch_ns) * 1e-9
        codes = self._look.codes(self._bearing(programme), seconds)
        status = HeadStatus.MOTOR_ERROR if self._motor_lost else HeadStatus(0)
        reply = programme.reply(self._nature.device_type, self.turning, codes, status)
        self.turning.advance(programme.way)
        self._owed -= 1
        self._ready_ns += self._period_ns(programme)
        return reply, max(at_ns + self._profile_ns(reply), self._asked_ns)

    def _begin(self, programme: Programme | None, now_ns: int) -> bool:
        if programme is None:
            return False
        self.programme = programme
        self._motor_lost = False
        self._owed = 0
        self._ready_ns = now_ns
        self.turning.begin(programme.way, programme.clockwise)
        self._look.tune(programme.listening, programme.bins, programme.step_angle)
        return True

    def _bearing(self, programme: Programme) -> float:
        """Return the true bearing [rad]: upside down the head turns the other way."""
        angle = bearing_angle(self.turning.bearing)
        told = HeadControl.INVERT in programme.control
        return -angle if self._nature.inverted and not told else angle

    def _period_ns(self, programme: Programme) -> int:
        return nanoseconds(programme.period(self._nature.baudrate))

    def _profile_ns(self, reply: HeadData) -> int:
        """Return the time from the ping until the reply is ready to be sent [ns]."""
        baudrate = self._nature.baudrate
        sending = transfer_time(reply.frame().size, baudrate)
        return nanoseconds(reply_delay(reply, baudrate) - sending)
