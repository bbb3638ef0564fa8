# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What is measured, and how ranges come out of echoes."""

from dataclasses import dataclass

from msss_graphslam.config.fields import parameter

__all__ = ["Segmentation", "Sensors", "Sonar"]


@dataclass(frozen=True, slots=True)
class Sonar:
    """The head: what a beam's numbers mean and where it is mounted."""

    intensity_scale: str = parameter(
        "db80",
        "what the codes 0..255 mean: 0..80 dB (Micron) or linear amplitude",
        choices=("db80", "linear"),
    )
    beam_width: float = parameter(
        0.0524, "full horizontal beam width at -3 dB", unit="rad", minimum=0.001, maximum=0.5
    )
    mount_x: float = parameter(0.0, "sonar_link in base_link, forward", unit="m")
    mount_y: float = parameter(0.0, "sonar_link in base_link, to port", unit="m")
    mount_yaw: float = parameter(
        0.0, "rotation of sonar_link against base_link", unit="rad", minimum=-3.15, maximum=3.15
    )

    @property
    def mount_position(self) -> tuple[float, float]:
        """Where ``sonar_link`` sits in ``base_link``, forward and to port [m]."""
        return self.mount_x, self.mount_y


@dataclass(frozen=True, slots=True)
class Sensors:
    """How messages of the other sensors are to be read."""

    gauge_pressure: bool = parameter(False, "pressure is relative to the air's, not absolute")
    water_density: float = parameter(
        1000.0, "density of the water", unit="kg/m^3", minimum=900.0, maximum=1100.0
    )
    reorder_window: float = parameter(
        0.2,
        "how long a measurement may be late before it is refused; all are worked off in the order"
        " of their stamps",
        unit="s",
        minimum=0.0,
        maximum=5.0,
    )
    patience: float = parameter(
        5.0,
        "a sensor that is silent for longer is not waited for when measurements are put into the"
        " order of their stamps",
        unit="s",
        minimum=0.5,
        maximum=60.0,
    )


@dataclass(frozen=True, slots=True)
class Segmentation:
    """From an echo profile to ranges (Section III-C; thresholds in dB)."""

    echo_contrast: float = parameter(
        14.0,
        "an echo must rise this far above the noise floor at its range",
        unit="dB",
        minimum=3.0,
        maximum=60.0,
        source="Section III-C, threshold",
    )
    dynamic_range: float = parameter(
        20.0,
        "an echo may lie this far under the strongest one of its beam, not further",
        unit="dB",
        minimum=3.0,
        maximum=80.0,
        source="Section III-C, dynamic threshold",
    )
    echo_drop: float = parameter(
        6.0,
        "level under its peak at which an echo begins and ends; dips this deep separate echoes",
        unit="dB",
        minimum=1.0,
        maximum=20.0,
    )
    echo_length: float = parameter(
        0.2,
        "length in range of a wall's echo; profiles are smoothed over a quarter of it, unless the"
        " bins are longer than the echo",
        unit="m",
        minimum=0.0,
        maximum=5.0,
    )
    speckle: float = parameter(
        2.3,
        "standard deviation of one bin's level",
        unit="dB",
        minimum=0.1,
        maximum=10.0,
    )
    surface_roughness: float = parameter(
        0.025,
        "standard deviation of a surface's relief within the beam's footprint",
        unit="m",
        minimum=0.0,
        maximum=1.0,
    )
    transducer_ringing: float = parameter(
        34.0,
        "highest level of the transducer's own ringing",
        unit="dB",
        minimum=0.0,
        maximum=80.0,
    )
    hull_ringing: float = parameter(
        41.0,
        "highest level of the echo off the vehicle's own hull",
        unit="dB",
        minimum=0.0,
        maximum=80.0,
    )
    hull_distance: float = parameter(
        0.25, "range of the nearest part of the hull", unit="m", minimum=0.0, maximum=10.0
    )
    ringing_range: float = parameter(
        1.6, "range at which the hull's echo has died out", unit="m", minimum=0.0, maximum=20.0
    )
    candidates: int = parameter(
        6, "echoes kept of a beam, the nearest first", minimum=1, maximum=20
    )
    ghost_contrast: float = parameter(
        16.0,
        "a surface this far under the strongest echo at its range in the turn is a ghost of it"
        " (sidelobes, mirror in the hull)",
        unit="dB",
        minimum=3.0,
        maximum=80.0,
    )
    ghost_window: float = parameter(
        0.5,
        "ranges this near count as the same range; covers the motion within a turn",
        unit="m",
        minimum=0.01,
        maximum=10.0,
    )
    level_step: float = parameter(
        6.0,
        "largest change of a surface's level from beam to beam",
        unit="dB",
        minimum=0.5,
        maximum=80.0,
    )
    steepest_incidence: float = parameter(
        1.2,
        "steepest incidence at which a wall still answers; echoes of neighbouring beams further"
        " apart than such a wall's do not belong together",
        unit="rad",
        minimum=0.0,
        maximum=1.55,
    )
