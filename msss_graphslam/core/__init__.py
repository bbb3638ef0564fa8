# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The paper's estimation, and what goes beyond it: pure, typed, deterministic."""
