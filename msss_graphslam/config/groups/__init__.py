# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Every parameter of the estimation and of the sonar's driver, by group."""

from msss_graphslam.config.groups.graph import Association, BackEnd, Matching
from msss_graphslam.config.groups.maps import Mapping
from msss_graphslam.config.groups.micron import Micron
from msss_graphslam.config.groups.motion import DeadReckoning, Scanning
from msss_graphslam.config.groups.sensing import Segmentation, Sensors, Sonar

__all__ = [
    "Association",
    "BackEnd",
    "DeadReckoning",
    "Mapping",
    "Matching",
    "Micron",
    "Scanning",
    "Segmentation",
    "Sensors",
    "Sonar",
]
