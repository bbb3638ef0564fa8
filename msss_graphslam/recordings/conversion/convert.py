# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Any known foreign recording to a bag."""

from collections import Counter
from dataclasses import dataclass
from pathlib import Path

from msss_graphslam.errors import UserError
from msss_graphslam.messages import topics
from msss_graphslam.recordings.conversion.foreign import ForeignFormat
from msss_graphslam.recordings.conversion.girona import Girona
from msss_graphslam.recordings.conversion.mcgill import McGill
from msss_graphslam.recordings.conversion.ping360 import Ping360
from msss_graphslam.recordings.conversion.robdos import RobDos
from msss_graphslam.recordings.conversion.source import ForeignSource
from msss_graphslam.recordings.conversion.udp_log import UdpLog
from msss_graphslam.recordings.conversion.v4log import V4Log
from msss_graphslam.recordings.files import require_absent
from msss_graphslam.recordings.mounting import Mounting
from msss_graphslam.recordings.writer import BagWriter

__all__ = ["FORMATS", "ConversionReport", "convert"]

FORMATS: tuple[ForeignFormat, ...] = (
    Girona(),
    RobDos(),
    McGill(),
    Ping360(),
    V4Log(),
    UdpLog(),
)


@dataclass(frozen=True, slots=True)
class ConversionReport:
    """What was converted: the format, the messages by topic, and the refused ones by reason."""

    source: str
    destination: str
    format: str
    messages: dict[str, int]
    refused: dict[str, int]


def convert(
    source: Path | str, destination: Path | str, mounting: Mounting | None = None
) -> ConversionReport:
    """Convert a foreign recording; a mounting goes into the bag's static transforms.

    Without one it is that of the data set, where there is only one vehicle. Raises UserError
    where the format is not known, the file damaged, no beam in it usable, or the destination
    there already.
    """
    destination, recording = Path(destination), ForeignSource(Path(source))
    require_absent(destination)
    chosen = _format_of(recording)
    counts: Counter[str] = Counter()
    refusals: Counter[str] = Counter()
    mounting = mounting or chosen.mounting
    inverted = mounting is not None and mounting.inverted
    with BagWriter(destination) as bag:
        for topic, message, log_ns in chosen.messages(recording, refusals, inverted):
            if mounting is not None and not counts:
                transforms = topics.STATIC_TRANSFORMS.absolute
                bag.write(transforms, mounting.transforms(log_ns), log_ns)
            bag.write(topic.absolute, message, log_ns)
            counts[topic.absolute] += 1
        if not counts[topics.SONAR_PING.absolute]:
            raise UserError(f"{source}: no usable beam in it (refused: {dict(refusals)})")
    return ConversionReport(
        str(source), str(destination), chosen.name, dict(counts), dict(refusals)
    )


def _format_of(source: ForeignSource) -> ForeignFormat:
    try:
        if not source.path.is_dir():
            source.path.open("rb").close()
    except OSError as error:
        raise UserError(f"{source.path}: cannot be read ({error.strerror})") from error
    for candidate in FORMATS:
        if candidate.recognises(source):
            return candidate
    known = "; ".join(candidate.description for candidate in FORMATS)
    raise UserError(f"{source.path}: the format is not known; known are: {known}")
