# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Every parameter of the estimation, by group."""

from dataclasses import dataclass

from msss_graphslam.config.fields import parameter

__all__ = [
    "Association",
    "BackEnd",
    "DeadReckoning",
    "Mapping",
    "Matching",
    "Scanning",
    "Segmentation",
    "Sensors",
    "Sonar",
]


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
        3, "echoes kept of a beam, the nearest first", minimum=1, maximum=20
    )
    ghost_contrast: float = parameter(
        16.0,
        "a surface this far under the strongest echo at its range in the turn is a ghost of it"
        " (sidelobes, mirror in the hull)",
        unit="dB",
        minimum=3.0,
        maximum=80.0,
    )
    surface_beams: int = parameter(
        3,
        "beams that see a surface, at least; a beam is wider than a step, so even a pole is in"
        " several, a speck in the water in one or two",
        minimum=1,
        maximum=20,
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


@dataclass(frozen=True, slots=True)
class DeadReckoning:
    """The EKF of Section IV-A."""

    surge_speed: float = parameter(
        0.1,
        "assumed forward speed while no DVL speaks",
        unit="m/s",
        minimum=-5.0,
        maximum=5.0,
        source="eq. 6, u_k",
    )
    surge_noise: float = parameter(
        0.03,
        "standard deviation of the forward speed's error",
        unit="m/s",
        minimum=1e-6,
        source="eq. 8, Q_u",
    )
    sway_noise: float = parameter(
        0.01,
        "standard deviation of the sideways speed's error",
        unit="m/s",
        minimum=1e-6,
        source="eq. 8, Q_u",
    )
    heave_noise: float = parameter(
        0.02,
        "standard deviation of the vertical speed's error",
        unit="m/s",
        minimum=1e-6,
        source="eq. 8, Q_u",
    )
    velocity_correlation_time: float = parameter(
        100.0,
        "correlation time of the speed's error; white noise would be overconfident",
        unit="s",
        minimum=0.01,
    )
    turn_rate_noise: float = parameter(
        0.05,
        "angle that the vehicle turns in a second while no gyro speaks, standard deviation",
        unit="rad/sqrt(s)",
        minimum=1e-6,
        source="eq. 8, Q_u",
    )
    gyro_noise: float = parameter(
        0.0005,
        "angle random walk of the gyro (noise of a sample times the root of its period)",
        unit="rad/sqrt(s)",
        minimum=1e-9,
        source="eq. 8, Q_u",
    )
    gyro_bias: float = parameter(
        0.0005,
        "standard deviation of the gyro's bias",
        unit="rad/s",
        minimum=0.0,
        source="eq. 8, Q_u",
    )
    compass_noise: float = parameter(
        0.009,
        "standard deviation of one AHRS angle",
        unit="rad",
        minimum=1e-6,
        source="eq. 10, R_a",
    )
    compass_drift: float = parameter(
        0.1,
        "standard deviation of the AHRS heading's slow bias, which is 0 at launch",
        unit="rad",
        minimum=0.0,
    )
    compass_correlation_time: float = parameter(
        500.0, "correlation time of that bias", unit="s", minimum=0.01
    )
    heading_time_constant: float = parameter(
        100.0,
        "the heading follows the gyro for shorter, the compass for longer than this",
        unit="s",
        minimum=0.01,
    )
    depth_noise: float = parameter(
        0.02,
        "standard deviation of one depth sample",
        unit="m",
        minimum=1e-6,
        source="eq. 9, R_d",
    )
    alignment_time: float = parameter(
        1.0,
        "AHRS samples of this span make the first attitude",
        unit="s",
        minimum=0.0,
        maximum=60.0,
    )
    innovation_gate: float = parameter(
        5.0,
        "an innovation larger than this many standard deviations is refused",
        minimum=1.0,
        maximum=100.0,
    )
    patience: float = parameter(
        2.0,
        "a sensor refused for this long is right and the state wrong: its variance is opened",
        unit="s",
        minimum=0.1,
        maximum=600.0,
    )
    sensor_timeout: float = parameter(
        0.5,
        "without IMU data for this long, beams clock the filter",
        unit="s",
        minimum=0.05,
        maximum=60.0,
    )


@dataclass(frozen=True, slots=True)
class Scanning:
    """When a turn is whole, and what a point's covariance is (Section IV-B)."""

    gap: float = parameter(
        2.0,
        "a silence between beams longer than this drops the turn in progress",
        unit="s",
        minimum=0.1,
        maximum=60.0,
    )
    part_turn: float = parameter(
        2.0,
        "the last turn becomes a scan if the head swept at least this much of it",
        unit="rad",
        minimum=0.0,
        maximum=6.3,
    )


@dataclass(frozen=True, slots=True)
class Association:
    """Which earlier scans may close a loop (Section V)."""

    mahalanobis_threshold: float = parameter(
        9.0, "Mt: largest squared Mahalanobis distance", minimum=0.0, source="Algorithm 3"
    )
    shape_threshold: float = parameter(
        0.45,
        "St: largest distance of the angle histograms",
        minimum=0.0,
        maximum=2.0,
        source="Algorithm 3",
    )
    reach: float = parameter(
        0.3,
        "scans this far apart still overlap, as a share of their median range (full only)",
        minimum=0.0,
        maximum=2.0,
    )
    most: int = parameter(
        4, "largest number of loop closures tried for a scan (full only)", minimum=1, maximum=1000
    )


@dataclass(frozen=True, slots=True)
class Matching:
    """How two scans are aligned (Section VI)."""

    iterations: int = parameter(40, "largest number of iterations", minimum=1, maximum=1000)
    compatibility: float = parameter(
        0.95,
        "spIC: probability content of the gate in which two points may be the same",
        minimum=0.1,
        maximum=0.9999,
        source="[30]",
    )
    smallest_step: float = parameter(
        0.001, "spIC: a step shorter than this is the last", unit="m", minimum=1e-9, maximum=0.1
    )
    smallest_turn: float = parameter(
        0.0005, "spIC: and turning less than this", unit="rad", minimum=1e-9, maximum=0.1
    )
    pairing_distance: float = parameter(
        0.5,
        "point-to-line pairs are looked for this far apart at the end, farther at first",
        unit="m",
        minimum=0.01,
        maximum=10.0,
    )
    overlap: float = parameter(
        0.5, "smallest share of points with a pair", minimum=0.0, maximum=1.0
    )
    disagreement: float = parameter(
        0.35, "largest distance of the match forwards and backwards", unit="m", minimum=0.0
    )
    disagreement_angle: float = parameter(
        0.05, "largest angle between the match forwards and backwards", unit="rad", minimum=0.0
    )
    shift: float = parameter(
        16.3,
        "largest squared Mahalanobis distance of a match from its first guess",
        minimum=0.0,
    )


@dataclass(frozen=True, slots=True)
class BackEnd:
    """The incremental smoother (Section III-B)."""

    robust_width: float = parameter(
        1.0,
        "Cauchy width of loop closures in standard deviations, 0 for least squares",
        minimum=0.0,
    )


@dataclass(frozen=True, slots=True)
class Mapping:
    """The maps (equation 5)."""

    resolution: float = parameter(
        0.1, "edge of a cell of the occupancy grid", unit="m", minimum=0.01, maximum=5.0
    )
    free_width: float = parameter(
        0.026,
        "sector about a beam's axis that is free water before the first return",
        unit="rad",
        minimum=0.0,
        maximum=0.5,
    )
    hit_probability: float = parameter(
        0.7, "probability that a cell with a return is occupied", minimum=0.5, maximum=0.999
    )
    miss_probability: float = parameter(
        0.4,
        "probability that a cell before a first return is occupied",
        minimum=0.001,
        maximum=0.5,
    )
