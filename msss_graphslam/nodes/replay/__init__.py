# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What a replay decides: which topics, when, and how far ahead of its listeners."""
