# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Scans on scans: spIC, point-to-line, and how unlike two scans look."""
