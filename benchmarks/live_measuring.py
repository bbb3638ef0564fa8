# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The measurements of ``python -m benchmarks.live``: real processes over real DDS."""

import filecmp
import subprocess
import sys
from contextlib import suppress
from pathlib import Path
from time import monotonic
from typing import Any

from rclpy.serialization import deserialize_message

from benchmarks.live_figures import (
    answer_times,
    complete_at,
    lost_messages,
    percentiles,
    turn_times,
)
from benchmarks.live_nodes import LiveNodes, replaying, running
from benchmarks.live_probe import Arrivals
from benchmarks.live_tables import Latency, NodeUsage, Replay, Traffic
from benchmarks.live_usage import cpu_seconds, memory, nodes_of
from msss_graphslam.messages import link_decoding, topics
from msss_graphslam.messages.refusal import Refusal
from msss_graphslam.messages.topics import Topic
from msss_graphslam.recordings.reader import open_recording
from msss_graphslam.ros.messages import message_class

__all__ = ["at_real_time", "bandwidth", "late_keyframes", "offline", "replay"]

_DIAGNOSTICS = Topic("diagnostics", "diagnostic_msgs/msg/DiagnosticArray")
_PROBED = (topics.SONAR_PING, topics.IMU, topics.ODOM, topics.POSE)
_SETTLING = 5.0
_REPLAY = "bag_replay"
_NOT_COUNTED = (_REPLAY,)
_TRAJECTORY = "trajectory.tum"


def at_real_time(
    bag: Path, scratch: Path, seconds: float
) -> tuple[dict[str, NodeUsage], list[Latency]]:
    """Replay at rate 1 for a time; return what the nodes use and how fast they answer."""
    with running(bag, 1.0, scratch / "real_time") as live:
        live.probe.listen(_PROBED)
        live.settle(topics.ODOM.name)
        usage = _usage(live, seconds)
        return usage, _prompt_latencies(live.probe.arrivals)


def bandwidth(bag: Path, scratch: Path, seconds: float) -> dict[str, Traffic]:
    """Replay at rate 1 for a time; return what every topic carries."""
    heard = (*topics.INPUTS, *topics.OUTPUTS, *topics.LINKS, _DIAGNOSTICS)
    with running(bag, 1.0, scratch / "bandwidth") as live:
        live.probe.listen(heard)
        live.settle(topics.ODOM.name)
        live.listen_for(seconds)
        heard_of = live.probe.arrivals
    return {name: Traffic(len(one.sizes), sum(one.sizes)) for name, one in heard_of.items()}


def replay(bag: Path, rate: float, scratch: Path, reference: Path) -> Replay:
    """Replay the whole bag; ``reference`` is the trajectory of the offline run."""
    output = scratch / f"rate_{rate:g}"
    rows: dict[str, dict[str, str]] = {}
    begun = monotonic()
    with running(bag, rate, output) as live:
        live.probe.listen([_DIAGNOSTICS], lambda data: _note(rows, data))
        live.probe.listen([topics.SETTLED_ODOMETRY])
        cpu: dict[str, float] = {}
        live.listen_to_the_end(lambda: cpu.update(_taken_in_replay(live)))
        whole = monotonic() - begun
        odometry = live.probe.arrivals[topics.SETTLED_ODOMETRY.name]
    mission, wall = (values[-1] - values[0] for values in (odometry.stamps, odometry.received))
    return Replay(
        asked=rate,
        rate=mission / wall,
        whole=whole,
        lost=lost_messages(rows),
        equal=filecmp.cmp(output / _TRAJECTORY, reference, shallow=False),
        mission=1e-9 * mission,
        cpu=cpu,
    )


def offline(bag: Path, scratch: Path) -> Path:
    """Run the estimator without any nodes; return its trajectory."""
    output = scratch / "offline"
    command = [sys.executable, "-m", "msss_graphslam", "run", str(bag), "--out", str(output)]
    subprocess.run([*command, "--quiet"], check=True, stdout=subprocess.DEVNULL)  # noqa: S603
    return output / _TRAJECTORY


def late_keyframes(
    bag: Path, scratch: Path, turns: int, seconds: float
) -> tuple[dict[str, NodeUsage], list[Latency]]:
    """Bring the nodes to a graph of so many turns at full speed, then go on at real time."""
    last_beams: dict[int, int] = {}
    with running(None, 1.0, scratch / "late") as live:
        live.probe.listen([topics.SCAN_BEAMS], lambda data: _note_turn(last_beams, data))
        live.probe.listen([topics.SONAR_PING, topics.KEYFRAMES])
        with replaying(bag, 0.0, 0.0):
            while len(last_beams) < turns:
                live.listen_for(0.1)
        ping = live.probe.arrivals[topics.SONAR_PING.name]
        offset = 1e-9 * (ping.stamps[-1] - open_recording(bag).start_ns)
        live.listen_for(_SETTLING)
        ping.clear()
        with replaying(bag, 1.0, offset):
            live.settle(topics.SONAR_PING.name)
            usage = _usage(live, seconds)
        return usage, _turn_latencies(live.probe.arrivals, last_beams)


def _usage(live: LiveNodes, seconds: float) -> dict[str, NodeUsage]:
    processes = nodes_of(live.process.pid)
    begun = monotonic()
    before = {name: cpu_seconds(process) for name, process in processes.items()}
    live.listen_for(seconds)
    span = monotonic() - begun
    return {
        name: NodeUsage(
            100.0 * (cpu_seconds(process) - before[name]) / span,
            memory(process),
            counted=name not in _NOT_COUNTED,
        )
        for name, process in processes.items()
    }


def _taken_in_replay(live: LiveNodes) -> dict[str, float]:
    """Return the CPU time [s] of each node so far, while the replay lasts."""
    processes = nodes_of(live.process.pid) if live.are_running else {}
    if _REPLAY not in processes:
        return {}
    taken = {}
    for name, process in processes.items():
        with suppress(FileNotFoundError, ProcessLookupError):
            taken[name] = cpu_seconds(process)
    return taken


def _prompt_latencies(arrivals: dict[str, Arrivals]) -> list[Latency]:
    odom, pose = arrivals[topics.ODOM.name], arrivals[topics.POSE.name]
    beams, imu = (_asked(arrivals[topic.name]) for topic in (topics.SONAR_PING, topics.IMU))
    both = complete_at(beams, imu)
    return [
        Latency(
            "beam and the IMU sample due with it, odom",
            percentiles(answer_times(both, odom.stamps, odom.received)),
            median_bar=0.005,
            p99_bar=0.025,
        ),
        Latency(
            "imu/data, its pose",
            percentiles(answer_times(imu, pose.stamps, pose.received)),
            median_bar=0.020,
        ),
        Latency(
            "beam, odom not older, waiting for the IMU included",
            percentiles(answer_times(beams, odom.stamps, odom.received)),
        ),
    ]


def _turn_latencies(arrivals: dict[str, Arrivals], last_beams: dict[int, int]) -> list[Latency]:
    sent = _asked(arrivals[topics.SONAR_PING.name])
    bars = {topics.SCAN_BEAMS.name: None, topics.KEYFRAMES.name: 0.5}
    latencies = []
    for name, bar in bars.items():
        answers = arrivals[name]
        times = turn_times(last_beams, sent, answers.stamps, answers.received)
        latencies.append(Latency(f"last beam of a turn, {name}", percentiles(times), p99_bar=bar))
    return latencies


def _asked(arrivals: Arrivals) -> dict[int, int]:
    return dict(zip(arrivals.stamps, arrivals.sent, strict=True))


def _note(rows: dict[str, dict[str, str]], data: bytes) -> None:
    message: Any = deserialize_message(data, message_class(_DIAGNOSTICS.type_name))
    for status in message.status:
        rows[status.name] = {row.key: row.value for row in status.values}


def _note_turn(last_beams: dict[int, int], data: bytes) -> None:
    message: Any = deserialize_message(data, message_class(topics.SCAN_BEAMS.type_name))
    with suppress(Refusal):
        scan = link_decoding.scan_beams(message)
        last_beams[scan.stamp_ns] = int(scan.beam_stamps_ns[-1])
