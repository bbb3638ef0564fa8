# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What stands behind the driver's node: a head at a port, or the bytes that one has sent."""
