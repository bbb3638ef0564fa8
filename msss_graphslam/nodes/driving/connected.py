# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""A head at the end of a line: a thread of its own reads, answers and publishes."""

import threading
import time
from collections import Counter
from collections.abc import Mapping

from msss_graphslam.config.groups import Micron
from msss_graphslam.core.types import Beam
from msss_graphslam.messages import encoding, topics
from msss_graphslam.micron.head_driver import HeadDriver
from msss_graphslam.micron.settings import HeadSettings
from msss_graphslam.nodes.driving.line import FileDriver, link_to, speaker_for
from msss_graphslam.nodes.driving.line_health import LineHealth
from msss_graphslam.nodes.driving.pings import Pings
from msss_graphslam.ros.diagnostics import Finding
from msss_graphslam.ros.faults import Faults
from msss_graphslam.ros.messages import make
from msss_graphslam.ros.node import SlamNode

__all__ = ["ConnectedHead"]

# The thread looks up so often at least [s]: at parameters that have changed, and at its end.
_PATIENCE = 0.2
_AFTER_A_FAULT = 0.5
# A line brings a few bytes every millisecond. To look at each of them costs a tenth of a core, so
# the rest of a packet is waited for, but not for so long that a head that is quicker has to wait.
_LONGEST_REST, _SHORTEST_REST = 0.016, 0.001
_BITS_PER_BYTE = 10
# A server that does not answer is waited for 2 s.
_END = 3.0


class ConnectedHead:
    """Talks with the head on the line that the parameters name, and publishes what comes.

    A port may be silent or missing for ever without the node's executor noticing: only the thread
    waits for it. Publishing is safe from any thread; all else is shared under a lock.
    """

    def __init__(self, node: SlamNode, pings: Pings, micron: Micron) -> None:
        self._node = node
        self._pings = pings
        self._raw = node.offer(topics.SONAR_RAW)
        self._lock = threading.Lock()
        self._own: Counter[str] = Counter()
        self._faults = Faults(self._own, node.log_error)
        self._link = link_to(micron)
        self._speaker = speaker_for(micron)
        self._byte_time = _BITS_PER_BYTE / micron.baudrate
        self._health = LineHealth(self._link, pings)
        self._was_open = False
        self._state = self._link.error
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, name="port", daemon=True)
        self._thread.start()

    @property
    def refused(self) -> Counter[str]:
        """What could not be used so far, by reason."""
        with self._lock:
            return _refused(self._speaker) + self._own

    @property
    def rows(self) -> Mapping[str, str | int | float]:
        """Further rows for the diagnostics."""
        with self._lock:
            return self._health.rows(self._speaker)

    def finding(self) -> Finding | None:
        """Return what is wrong now."""
        with self._lock:
            return self._health.finding(self._speaker)

    def configure(self, micron: Micron) -> None:
        """Have the head scan otherwise from now on."""
        with self._lock:
            if isinstance(self._speaker, HeadDriver):
                self._speaker.configure(HeadSettings(micron))

    def reset(self) -> None:
        """Leave the head at its work: its next beam is as good as any."""

    def unfinished(self) -> str:
        """Return nothing: what has come in has gone out."""
        return ""

    def close(self) -> None:
        """End; nothing is published afterwards."""
        self._stop.set()
        self._thread.join(_END)
        self._raw.close()

    def _run(self) -> None:
        while not self._stop.is_set():
            try:
                self._step()
            except Exception as error:
                with self._lock:
                    self._faults.note(error, "port")
                self._stop.wait(_AFTER_A_FAULT)
        self._link.close()

    def _step(self) -> None:
        """Wait for bytes, answer them, and publish what they are."""
        rest = self._speaker.missing * self._byte_time
        if self._link.is_open and rest >= _SHORTEST_REST:
            time.sleep(min(rest, _LONGEST_REST))
        data = self._link.read(self._patience())
        now_ns = self._now_ns()
        with self._lock:
            self._follow_the_line(now_ns)
            self._health.received(len(data))
            beams = self._speaker.feed(data, now_ns) if data else []
            period = _period(self._speaker) if beams else 0.0
            packets = self._speaker.due(now_ns) if self._link.is_open else []
        # First the head gets its next request: it measures while these beams go out.
        for packet in packets:
            self._link.write(packet)
        self._tell_state()
        if not self._stop.is_set():
            self._publish(data, now_ns, beams, period)

    def _patience(self) -> float:
        next_ns = self._speaker.next_ns
        if next_ns is None:
            return _PATIENCE
        return min(max((next_ns - self._now_ns()) * 1e-9, 0.0), _PATIENCE)

    def _follow_the_line(self, now_ns: int) -> None:
        if self._link.is_open == self._was_open:
            return
        self._was_open = self._link.is_open
        if self._was_open:
            self._health.opened(self._speaker)
            self._speaker.opened(now_ns)
        else:
            self._speaker.closed(now_ns)

    def _publish(self, data: bytes, now_ns: int, beams: list[Beam], period: float) -> None:
        if self._node.paused:
            with self._lock:
                self._own.update({"paused": len(beams)} if beams else {})
            return
        if data:
            self._raw.publish(encoding.raw_bytes(make, data, now_ns))
        for beam in beams:
            self._pings.publish(beam, period)

    def _tell_state(self) -> None:
        """Log how the line and the head are, when that has changed."""
        state = f"head: {self._speaker.state}" if self._link.is_open else self._link.error
        if state != self._state:
            self._state = state
            tell = self._node.log if self._link.is_open else self._node.log_error
            tell(state)

    def _now_ns(self) -> int:
        return int(self._node.get_clock().now().nanoseconds)


def _refused(speaker: HeadDriver | FileDriver) -> Counter[str]:
    return speaker.refused if isinstance(speaker, FileDriver) else speaker.status.refused


def _period(speaker: HeadDriver | FileDriver) -> float:
    return speaker.period if isinstance(speaker, FileDriver) else speaker.status.period
