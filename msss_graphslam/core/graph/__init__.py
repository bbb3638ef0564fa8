# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Sections IV to VI: which scans belong together, and the pose graph that they make."""
