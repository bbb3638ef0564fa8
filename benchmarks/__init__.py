# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What the estimators cost and how accurate they are: ``make bench``, ``make reproduce``."""
