# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What the driver's node asks of where the bytes come from."""

from collections import Counter
from collections.abc import Mapping
from typing import Protocol

from msss_graphslam.config.groups import Micron
from msss_graphslam.ros.diagnostics import Finding

__all__ = ["ByteSource"]


class ByteSource(Protocol):
    """A head at a port, or the bytes that one has sent."""

    @property
    def refused(self) -> Counter[str]:
        """What could not be used so far, by reason."""

    @property
    def rows(self) -> Mapping[str, str | int | float]:
        """Further rows for the diagnostics."""

    def finding(self) -> Finding | None:
        """Return what is wrong now."""

    def configure(self, micron: Micron) -> None:
        """Take over parameters that do not concern the connection."""

    def reset(self) -> None:
        """Start anew, as far as that leaves the head at its work."""

    def unfinished(self) -> str:
        """Return what is still to be worked off before a save; empty if nothing is."""

    def close(self) -> None:
        """End; nothing is published afterwards."""
