# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The command with a head, emulated: from its bytes to the files, and the recording."""

import json
import sys
from pathlib import Path

import pytest
from command_line import msss

pytest.importorskip("rclpy")
from nodes.emulated_heads import emulated
from nodes.processes import NodeProcess, TestNode, domain, wait_until

from msss_graphslam.messages import topics
from msss_graphslam.recordings.reader import open_recording
from msss_graphslam.ros.messages import message_class
from msss_graphslam.ros.qos import profile_of

pytestmark = pytest.mark.slow

LIMIT = 120.0


def test_a_dive_with_the_head_alone_is_recorded_and_run_again(tmp_path: Path) -> None:
    port, out, dive = tmp_path / "head", tmp_path / "out", tmp_path / "dive"
    command = [sys.executable, "-m", "msss_graphslam", "live", "--out", str(out)]
    command += ["--record", str(dive), "--set", f"micron.port={port}"]
    command += ["--set", "micron.step_deg=3.6", "--set", "micron.range_m=15"]
    with domain() as own, emulated(own, "--pty", port), TestNode(own) as ear:
        scans: list[bytes] = []
        kind = message_class(topics.SCAN.type_name)
        ear.node.create_subscription(kind, "scan", scans.append, profile_of(topics.SCAN), raw=True)
        with NodeProcess(command, own) as live:
            wait_until(lambda: len(scans) >= 2, "two scans", LIMIT)
            assert "head: scanning" in (out / "log" / "micron_driver.log").read_text()
            assert live.interrupt(LIMIT) in (0, 3), live.output
    summary = json.loads((out / "summary.json").read_text(encoding="utf-8"))
    assert summary["scans"] >= 2
    recording = open_recording(dive)
    assert all(recording.topics[name].count > 150 for name in ("/sonar/raw", "/sonar/ping"))
    again = msss("run", dive, "--out", tmp_path / "again")
    assert again.returncode in (0, 3)
    assert (tmp_path / "again" / "trajectory.tum").exists()
