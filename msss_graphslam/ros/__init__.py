# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What every node shares: messages, parameters, QoS, diagnostics, the node itself."""
