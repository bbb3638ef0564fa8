# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The node that speaks with a Tritech Micron, or decodes what one has sent."""

from collections import Counter
from dataclasses import replace
from functools import partial

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.config.groups import Micron
from msss_graphslam.errors import UserError
from msss_graphslam.messages.refusal import in_one_word
from msss_graphslam.micron.settings import HeadSettings
from msss_graphslam.nodes.driving.connected import ConnectedHead
from msss_graphslam.nodes.driving.pings import Pings
from msss_graphslam.nodes.driving.recorded import RecordedHead
from msss_graphslam.nodes.driving.source import ByteSource
from msss_graphslam.ros.diagnostics import Finding, Level
from msss_graphslam.ros.node import SlamNode, leave, run

__all__ = ["MicronDriverNode", "main"]

_CONNECTION = {
    "serial": ("port", "baudrate"),
    "tcp": ("host", "tcp_port", "baudrate"),
    "topic": ("baudrate",),
    "file": ("file", "baudrate"),
}
"""By source the parameters of which another value closes the line and opens another."""
_LOOK_EVERY = 0.5


class MicronDriverNode(SlamNode):
    """Bytes of a head in, beams out; never anything in place of a head that is not there."""

    def __init__(self) -> None:
        super().__init__("micron_driver", ("micron",), ("micron",), flat=("micron",))
        self._unfit = ""
        self._counted: Counter[str] = Counter()
        self._pings = Pings(self)
        self._micron = self._fitting(self.parameters.configuration.micron)
        self._source = self._opened()
        self.diagnostics.values["source"] = lambda: self._micron.source
        self.diagnostics.values["beams"] = lambda: self._pings.count
        self.diagnostics.values["beams_per_s"] = lambda: self._pings.rate
        self.diagnostics.values["stamp_jitter_ms"] = lambda: self._pings.jitter_ms
        self.diagnostics.checks += [lambda: self._source.finding(), self._misfit]
        self.every(_LOOK_EVERY, self._look)

    def check_parameters(self, configuration: Configuration) -> None:
        """Raise UserError where no head can do what is asked for."""
        HeadSettings(configuration.micron)

    def on_parameters(self, configuration: Configuration) -> None:
        """Tell the head, or go to another port."""
        before, self._micron = self._micron, configuration.micron
        self._unfit = ""
        if _connection(before) != _connection(self._micron):
            self._close()
            self._source = self._opened()
        else:
            self._pings.frame_id = self.frame(self._micron.frame_id)
            self._source.configure(self._micron)

    def on_reset(self) -> None:
        """Start anew with what comes next; a head goes on with its turn."""
        self._source.reset()

    def on_save(self) -> tuple[bool, str]:
        """Work off what has been sent to the node."""
        unfinished = self._source.unfinished()
        if unfinished:
            return False, unfinished
        self._look()
        self.diagnostics.publish()
        return True, f"{self._pings.count} beams published"

    def on_shutdown(self) -> None:
        """Leave the port."""
        self._close()

    def _fitting(self, micron: Micron) -> Micron:
        """Return the parameters of the start, with the default range where no head can do them."""
        try:
            HeadSettings(micron)
        except UserError as error:
            default = Micron()
            self._unfit = f"{error}; range {default.range_m:g} m, {default.bins} bins are used"
            self.log_error(self._unfit)
            return replace(micron, range_m=default.range_m, bins=default.bins)
        return micron

    def _opened(self) -> ByteSource:
        self._counted = Counter()
        self._pings.frame_id = self.frame(self._micron.frame_id)
        if self._micron.source == "topic":
            return RecordedHead(self, self._pings, self._micron)
        return ConnectedHead(self, self._pings, self._micron)

    def _close(self) -> None:
        self._source.close()
        self._look()
        for key in self._source.rows:
            self.diagnostics.values.pop(key, None)

    def _look(self) -> None:
        """Take over what the source has counted since the last look."""
        refused = self._source.refused
        for reason, count in (refused - self._counted).items():
            self.diagnostics.refused[in_one_word(reason)] += count
        self._counted = refused
        for key in self._source.rows:
            self.diagnostics.values[key] = partial(self._row, key)

    def _row(self, key: str) -> str | int | float:
        return self._source.rows.get(key, "none")

    def _misfit(self) -> Finding | None:
        return Finding(Level.ERROR, self._unfit) if self._unfit else None


def _connection(micron: Micron) -> tuple[object, ...]:
    names = _CONNECTION[micron.source]
    return micron.source, *(getattr(micron, name) for name in names)


def main() -> int:
    """Run the node."""
    return run(MicronDriverNode)


if __name__ == "__main__":
    leave(main())
