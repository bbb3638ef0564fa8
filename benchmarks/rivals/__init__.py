# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Our parts beside what others would take in their place, on the same data, in one run."""
