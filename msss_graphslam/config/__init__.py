# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""One typed configuration, from which ROS parameters, YAML, options and the docs are made."""
