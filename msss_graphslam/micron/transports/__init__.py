# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Where the head's bytes come from and go to: a serial port, a serial server, a file."""
