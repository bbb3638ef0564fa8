# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What a node loads: a package that it does not use takes memory from the vehicle's computer."""

import subprocess
import sys

import pytest

HEAVY = {"gtsam", "jinja2", "matplotlib", "mcap", "numba", "rich", "rosbags", "scipy"}


@pytest.mark.parametrize(
    ("node", "used"),
    [
        ("dead_reckoning", set()),
        ("scan_generation", set()),
        ("front_end", set()),
        ("back_end", {"gtsam"}),
        ("bag_replay", {"mcap", "rosbags"}),
    ],
)
def test_a_node_loads_no_package_that_it_does_without(node: str, used: set[str]) -> None:
    program = f"import sys, msss_graphslam.nodes.{node}; print(*sys.modules)"
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, timeout=60, check=True
    )
    loaded = {name.partition(".")[0] for name in done.stdout.split()}
    assert loaded & HEAVY == used
