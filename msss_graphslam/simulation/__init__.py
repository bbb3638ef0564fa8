# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Simulated missions: worlds, vehicle, sensors and sonar, written as bags with their truth."""
