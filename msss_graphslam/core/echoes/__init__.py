# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""From echo profiles to the ranges of surfaces: Section III-C, and what is no surface."""
