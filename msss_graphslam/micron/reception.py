# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""From the head's bytes to beams: the one path for a live head and for recorded bytes."""

from collections import Counter
from collections.abc import Iterable

from msss_graphslam.core.types import Beam
from msss_graphslam.micron.beam import beam_of
from msss_graphslam.micron.framing import Framer
from msss_graphslam.micron.packets import (
    HeadData,
    HeadStatus,
    Packet,
    PacketError,
    Unknown,
    decode_packet,
)
from msss_graphslam.micron.stamping import TransmitClock

__all__ = ["Reception", "fault_of"]


class Reception:
    """Packets out of bytes, beams out of data packets; what is neither is counted."""

    def __init__(self, sound_speed: float, inverted: bool, baudrate: int) -> None:
        self.sound_speed = sound_speed
        self.inverted = inverted
        self._framer = Framer()
        self._clock = TransmitClock(baudrate)
        self._refused: Counter[str] = Counter()
        self._last: tuple[HeadData, int] | None = None

    @property
    def refused(self) -> Counter[str]:
        """What could not be used so far, by reason."""
        return self._refused + self._framer.refused

    @property
    def skipped_bytes(self) -> int:
        """Bytes so far that belong to no packet."""
        return self._framer.skipped_bytes

    @property
    def missing(self) -> int:
        """Bytes that the packet that has begun lacks, 0 where none has."""
        return self._framer.missing

    @property
    def restarts(self) -> Counter[str]:
        """How often the stamps had to start anew, by reason."""
        return self._clock.restarts

    @property
    def period(self) -> float:
        """The time [s] between two beams as observed; 0 before the first."""
        return self._clock.period

    def break_off(self) -> None:
        """Forget the packet that has only come in part: the line was cut."""
        self._framer.reset()

    def packets(self, data: bytes) -> list[Packet]:
        """Return the packets that the next bytes complete."""
        packets: list[Packet] = []
        for frame in self._framer.feed(data):
            try:
                packet = decode_packet(frame)
            except PacketError as error:
                self._refused[error.reason] += 1
                continue
            if isinstance(packet, Unknown):
                self._refused["unknown packet"] += 1
            packets.append(packet)
        return packets

    def beams(self, packets: Iterable[Packet], received_ns: int) -> list[Beam]:
        """Return the beams of packets that arrived in one piece at ``received_ns``."""
        usable = [
            packet
            for packet in packets
            if isinstance(packet, HeadData) and self._is_usable(packet, received_ns)
        ]
        stamps = self._clock.stamp_all(received_ns, usable)
        return [
            beam_of(packet, stamp, self.sound_speed, self.inverted)
            for packet, stamp in zip(usable, stamps, strict=True)
            if self._is_a_time(stamp)
        ]

    def _is_usable(self, packet: HeadData, received_ns: int) -> bool:
        reason = fault_of(packet)
        if not reason and self._is_repeated(packet, received_ns):
            reason = "beam sent twice"
        if reason:
            self._refused[reason] += 1
            return False
        self._last = packet, received_ns
        return True

    def _is_repeated(self, packet: HeadData, received_ns: int) -> bool:
        """Whether it is the last beam again, sooner than the head could measure another.

        Two echoes are never equal in all bins, nor does the head stand still between two beams.
        """
        if self._last is None or packet != self._last[0]:
            return False
        return abs(received_ns - self._last[1]) < 0.5 * self._clock.modelled(packet)

    def _is_a_time(self, stamp_ns: int) -> bool:
        if stamp_ns < 0:
            self._refused["beam before the clock's start"] += 1
        return stamp_ns >= 0


def fault_of(packet: HeadData) -> str:
    """Return why a data packet is no beam, or nothing."""
    if HeadStatus.MOTOR_ERROR in packet.status:
        return "head has lost its bearing"
    if HeadStatus.POWER_LOSS in packet.status:
        return "head has lost its parameters"
    if packet.bins == 0 or packet.ad_interval == 0:
        return "head data without bins"
    return ""
