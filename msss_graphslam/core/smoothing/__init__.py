# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""All scans and keyframes in one least-squares problem: beyond the paper."""
