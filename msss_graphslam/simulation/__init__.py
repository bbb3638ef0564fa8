# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Worlds, vehicle, sonar and sensors; shares no code with the estimators."""
