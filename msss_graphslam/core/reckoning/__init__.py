# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Section III-A: the extended Kalman filter of dead reckoning, and what feeds it."""
