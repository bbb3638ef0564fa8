# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What can be saved of a damaged recording."""

from collections import Counter
from dataclasses import dataclass
from pathlib import Path

from msss_graphslam.recordings.damage import Damage
from msss_graphslam.recordings.files import require_absent
from msss_graphslam.recordings.reader import open_recording
from msss_graphslam.recordings.writer import BagWriter

__all__ = ["SalvageReport", "salvage"]


@dataclass(frozen=True, slots=True)
class SalvageReport:
    """Messages saved, by topic, and what was lost."""

    source: str
    destination: str
    messages: dict[str, int]
    damage: Damage


def salvage(source: Path | str, destination: Path | str) -> SalvageReport:
    """Copy every whole message of a recording, byte by byte and with its times, to a new one.

    Nothing is repaired or filled in. Raises UserError where nothing is readable, or where the
    destination exists already.
    """
    destination = Path(destination)
    require_absent(destination)
    recording = open_recording(source)
    saved: Counter[str] = Counter()
    with BagWriter(destination) as bag:
        for message in recording.messages():
            bag.copy(message)
            saved[message.channel.topic] += 1
    return SalvageReport(
        str(source), str(destination), dict(sorted(saved.items())), recording.damage
    )
