# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What a run promises to leave in its directory."""

ESTIMATE_FILES = {
    "constraints.csv",
    "dead_reckoning.tum",
    "graph.g2o",
    "keyframes.tum",
    "map.pgm",
    "map.ply",
    "map.yaml",
    "online.tum",
    "result.mcap",
    "trajectory.tum",
}
RUN_FILES = ESTIMATE_FILES | {"figures", "report.html", "summary.json"}
