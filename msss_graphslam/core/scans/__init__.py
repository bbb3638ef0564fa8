# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Section III-B: turns become scans in one frame; how they are laid out anew."""
