# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Graph SLAM for underwater vehicles with a mechanical scanning sonar."""

__version__ = "0.1.0"
