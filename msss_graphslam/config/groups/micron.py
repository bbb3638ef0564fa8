# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The Tritech Micron: where the head is connected, and what it is told to do."""

from dataclasses import dataclass

from msss_graphslam.config.fields import parameter

__all__ = ["Micron"]


@dataclass(frozen=True, slots=True)
class Micron:
    """The head and its connection; ``micron_driver`` takes these without the group's name."""

    source: str = parameter(
        "serial",
        "where the head's bytes come from: a serial port, a serial server (tcp), sonar/raw (topic)"
        " or a file of bytes as they came from the port",
        choices=("serial", "tcp", "topic", "file"),
    )
    port: str = parameter("/dev/ttyUSB0", "serial port of the head (source serial)")
    baudrate: int = parameter(
        115200, "speed of the line to the head", unit="Bd", minimum=4800, maximum=921600
    )
    host: str = parameter("localhost", "name or address of the serial server (source tcp)")
    tcp_port: int = parameter(
        4001, "port of the serial server (source tcp)", minimum=1, maximum=65535
    )
    file: str = parameter(
        "", "file with the head's bytes (source file), played at the head's own pace"
    )
    head_type: str = parameter(
        "dst",
        "how the head is spoken to: dst (Micron DST) or seaking (SeaKing, SeaPrince, old Micron)",
        choices=("dst", "seaking"),
    )
    range_m: float = parameter(
        20.0, "range of the last bin", unit="m", minimum=0.5, maximum=100.0, source="Section VII"
    )
    bins: int = parameter(
        350, "number of bins of a beam", minimum=20, maximum=800, source="Section VII"
    )
    step_deg: float = parameter(
        1.8,
        "angle between two beams, rounded to a sixteenth of a gradian",
        unit="deg",
        minimum=0.225,
        maximum=7.2,
        source="Section VII",
    )
    gain: float = parameter(
        0.4, "gain of the receiver, 0 to 1 for 0 to 80 dB", minimum=0.0, maximum=1.0
    )
    data_bits: int = parameter(
        8, "bits of a bin: 8 for steps of 0.3 dB, 4 for steps of 5 dB", choices=(8, 4)
    )
    sector_deg: float = parameter(
        360.0,
        "width of the sector that is swept to and fro; 360 turns round and round",
        unit="deg",
        minimum=10.0,
        maximum=360.0,
    )
    sector_centre_deg: float = parameter(
        0.0,
        "middle of the sector in sonar_link, 0 ahead, counter-clockwise",
        unit="deg",
        minimum=-180.0,
        maximum=180.0,
    )
    sound_speed: float = parameter(
        1500.0, "speed of sound in the water", unit="m/s", minimum=1400.0, maximum=1600.0
    )
    inverted: bool = parameter(False, "the head is mounted with its transducer downwards")
    frame_id: str = parameter("sonar_link", "frame of the beams")
