# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Records the inputs and outputs of the nodes, serialised as they come."""

import signal
import sys
import time
from collections import Counter
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any, cast

from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.utilities import try_shutdown

from msss_graphslam.errors import UserError
from msss_graphslam.messages import topics
from msss_graphslam.messages.topics import Topic
from msss_graphslam.nodes.fitting_subscription import FittingSubscription
from msss_graphslam.nodes.recorded_time import RecordedTime
from msss_graphslam.recordings.files import require_absent
from msss_graphslam.recordings.unfinished import set_aside
from msss_graphslam.recordings.writer import BagWriter
from msss_graphslam.ros.diagnostics import Diagnostics
from msss_graphslam.ros.messages import available, make, message_class
from msss_graphslam.ros.qos import DEEP, name_of
from msss_graphslam.ros.running import begin, leave

__all__ = ["BagRecorder", "main"]

# So much of a dive is lost at most when the process is killed [s].
_FLUSH_PERIOD = 1.0
_DIAGNOSTICS = Topic("diagnostics", "diagnostic_msgs/msg/DiagnosticArray")


class BagRecorder(Node):
    """Writes every message of the package's topics into a bag.

    Log time is this node's time of arrival, in a replay its clock's at publishing; publish time
    that of the publisher.
    """

    def __init__(self) -> None:
        super().__init__("bag_recorder")
        self.output = self._read_output()
        self.counts: Counter[str] = Counter()
        self._bytes = 0
        self._since = time.monotonic(), 0
        is_replayed = bool(self.get_parameter("use_sim_time").value)
        self.time = RecordedTime(lambda: self.get_clock().now().nanoseconds, is_replayed)
        if is_replayed:
            self._follow_clock()
        self.diagnostics = Diagnostics(self)
        self.diagnostics.values["bytes_per_s"] = self._byte_rate

    def record_into(self, writer: BagWriter) -> None:
        """Begin to record."""
        for topic in (*topics.INPUTS, *topics.OUTPUTS, _DIAGNOSTICS):
            self._record(writer, topic)
        self.create_timer(_FLUSH_PERIOD, writer.flush, clock=_steady())

    def _follow_clock(self) -> None:
        def tick(message: Any, info: Any) -> None:
            clock_ns = message.clock.sec * 1_000_000_000 + message.clock.nanosec
            self.time.tick(info["source_timestamp"], clock_ns)

        kind = message_class("rosgraph_msgs/msg/Clock")
        self.create_subscription(kind, "/clock", cast(Any, tick), DEEP)

    def _read_output(self) -> Path:
        descriptor = make(
            "rcl_interfaces/msg/ParameterDescriptor",
            description="the bag: NAME.mcap for a single file, else a rosbag2 folder",
            read_only=True,
        )
        output = self.declare_parameter("output", "", descriptor).value
        if not output:
            raise UserError("parameter output is missing: give the bag to be written")
        return Path(output)

    def _record(self, writer: BagWriter, topic: Topic) -> None:
        name = name_of(topic)
        if not available(topic.type_name):
            self.get_logger().info(f"{name} is not recorded: no {topic.type_name} installed")
            return
        full = self.resolve_topic_name(name)

        # rclpy hands the delivery's description to a callback that takes two arguments.
        def take(data: Any, info: Any) -> None:
            write = partial(writer.write_raw, full, topic.type_name, data)
            # A middleware that does not tell says 0.
            self.time.date(info["source_timestamp"], write)
            self.counts[full] += 1
            self._bytes += len(data)

        self.diagnostics.values[f"recorded/{full}"] = lambda: self.counts[full]
        warn = self.get_logger().warning
        FittingSubscription(self, topic, name, cast(Any, take), warn)

    def _byte_rate(self) -> float:
        """Return the bytes a second since the last call."""
        now = time.monotonic()
        (then, before), self._since = self._since, (now, self._bytes)
        return (self._bytes - before) / max(now - then, 1e-3)


def _steady() -> Clock:
    return Clock(clock_type=ClockType.STEADY_TIME)


class _Stop:
    """Set by a signal: what is being written is finished first."""

    def __init__(self) -> None:
        self.is_asked = False
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, self._ask)

    def _ask(self, *_: Any) -> None:
        self.is_asked = True


def _record(stop: _Stop) -> Iterator[str]:
    """Record until asked to stop; yields what there is to say."""
    node = BagRecorder()
    try:
        require_absent(node.output)
        left = set_aside(node.output)
        if left is not None:
            yield f"an earlier recording was cut off; what there is of it is kept as {left}"
        with BagWriter(node.output, keeps_partial=True) as writer:
            node.record_into(writer)
            yield f"recording into {node.output}"
            _spin(node, stop)
            node.time.finish()
        yield f"{node.counts.total()} messages recorded into {node.output}"
    finally:
        node.destroy_node()


def _spin(node: Node, stop: _Stop) -> None:
    executor = SingleThreadedExecutor(context=node.context)
    executor.add_node(node)
    try:
        while not stop.is_asked:
            executor.spin_once(timeout_sec=0.1)
    except ExternalShutdownException:
        pass
    finally:
        executor.shutdown()


def main() -> int:
    """Run the node until a signal comes; return its exit code."""
    stop = _Stop()
    try:
        begin()
        for line in _record(stop):
            print(f"bag_recorder: {line}", flush=True)
    except (UserError, OSError) as error:
        print(f"bag_recorder: {error}", file=sys.stderr)
        return 1
    finally:
        try_shutdown()
    return 0


if __name__ == "__main__":
    leave(main())
