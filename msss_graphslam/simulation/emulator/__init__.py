# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""A Micron's head to practise with: the other end of the driver's line, looking into a world."""
