# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Dead reckoning and the scans that are laid out by it."""

from dataclasses import dataclass

from msss_graphslam.config.fields import parameter

__all__ = ["DeadReckoning", "Scanning"]


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
    drift_noise: float = parameter(
        0.5,
        "way that the vehicle drifts in a second, ahead or sideways, without any IMU or DVL",
        unit="m/sqrt(s)",
        minimum=0.0,
    )
    turn_rate_noise: float = parameter(
        0.1,
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
