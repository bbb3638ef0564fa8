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

    threshold: float = parameter(
        12.0, "an echo must rise this far above the noise floor", unit="dB", minimum=0.0
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
        minimum=0.0,
        source="eq. 8, Q_u",
    )
    sway_noise: float = parameter(
        0.01,
        "standard deviation of the sideways speed's error",
        unit="m/s",
        minimum=0.0,
        source="eq. 8, Q_u",
    )
    heave_noise: float = parameter(
        0.02,
        "standard deviation of the vertical speed's error",
        unit="m/s",
        minimum=0.0,
        source="eq. 8, Q_u",
    )
    velocity_correlation_time: float = parameter(
        100.0,
        "correlation time of the speed's error; white noise would be overconfident",
        unit="s",
        minimum=0.01,
    )
    gyro_noise: float = parameter(
        0.0026,
        "standard deviation of one gyro sample",
        unit="rad/s",
        minimum=0.0,
    )
    gyro_bias: float = parameter(
        0.0005,
        "standard deviation of the gyro's bias",
        unit="rad/s",
        minimum=0.0,
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
    depth_noise: float = parameter(
        0.02,
        "standard deviation of one depth sample",
        unit="m",
        minimum=1e-6,
        source="eq. 9, R_d",
    )
    alignment_time: float = parameter(
        1.0,
        "AHRS samples of this span make the first heading",
        unit="s",
        minimum=0.0,
        maximum=60.0,
    )
    innovation_gate: float = parameter(
        0.9999,
        "probability content of the innovation gates",
        minimum=0.5,
        maximum=0.9999999,
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


@dataclass(frozen=True, slots=True)
class Matching:
    """How two scans are aligned (Section VI)."""

    iterations: int = parameter(40, "largest number of iterations", minimum=1, maximum=1000)


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
