# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Replays a bag into the nodes, as fast as they take it and without loss."""

import signal
import sys
from typing import Any

from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.utilities import try_shutdown

from msss_graphslam.errors import UserError
from msss_graphslam.messages import topics
from msss_graphslam.nodes.conclusion import conclude, reset
from msss_graphslam.nodes.names import DRIVER, SLAM_NODES
from msss_graphslam.nodes.replay.flow import Flow
from msss_graphslam.nodes.replay.output import Output
from msss_graphslam.nodes.replay.pacing import BATCH_NS, Pace, batches
from msss_graphslam.nodes.replay.progress import Progress
from msss_graphslam.nodes.replay.selection import select
from msss_graphslam.nodes.replay.settings import ReplaySettings
from msss_graphslam.recordings.mcap_reading import RawMessage
from msss_graphslam.recordings.reader import open_recording
from msss_graphslam.ros.diagnostics import Diagnostics
from msss_graphslam.ros.messages import available, make, message_class
from msss_graphslam.ros.running import begin, leave

__all__ = ["BagReplay", "main"]

_CLOCK_PERIOD_NS = 10_000_000
_EVENTS = 3
_WORTH_WAITING = 5e-4


class BagReplay(Node):
    """Publishes what a bag holds: serialised messages as they are, at the times of their log."""

    def __init__(self) -> None:
        super().__init__("bag_replay")
        self._settings = ReplaySettings.of(self)
        self._recording = open_recording(self._settings.bag)
        selected, left_out = select(self._recording, self._settings.topics, available)
        for topic in left_out:
            self.get_logger().info(f"{topic.name} is left out: no {topic.type_name} installed")
        self._names = {topic.name for topic in selected}
        # The driver takes part only where it makes beams of recorded bytes.
        is_raw = any(topics.SONAR_RAW.matches(name) for name in self._names)
        self._concerned = (DRIVER, *SLAM_NODES) if is_raw else SLAM_NODES
        self._start_ns = self._recording.start_ns + round(self._settings.start_offset * 1e9)
        self._pace = Pace(self._settings.rate)
        self._output = Output(self, selected)
        self._waited_for = self._settings.awaited(self._output.by_name)
        self._is_paused = False
        self._published = self._clock_ns = 0
        self._prepare()

    def play(self) -> None:
        """Replay the bag, wait until all is worked off, and have the nodes save."""
        self._flow.gather()
        self._lap()
        while self._settings.loop:
            self._start_anew()
            self._lap()
        if self._settings.conclude:
            messages = conclude(self, self._concerned, self.get_logger().info)
            for name, message in messages.items():
                self.get_logger().info(f"{name} is done: {message}")

    def _prepare(self) -> None:
        self._executor = SingleThreadedExecutor(context=self.context)
        self._executor.add_node(self)
        self._flow = Flow(
            self,
            self._output,
            self._waited_for,
            self._settings.patience,
            self._executor.spin_once,
        )
        self._time = None
        if self._settings.clock:
            kind = make("rosgraph_msgs/msg/Clock")
            self._time = self.create_publisher(type(kind), "/clock", 10)
        self.create_service(message_class("std_srvs/srv/SetBool"), "~/pause", self._on_pause)
        self._diagnose()

    def _diagnose(self) -> None:
        self._diagnostics = Diagnostics(self)
        self._diagnostics.values["replayed"] = lambda: self._published
        self._diagnostics.values["stalls"] = lambda: self._flow.stalls
        self._diagnostics.values["given_up"] = lambda: " ".join(sorted(self._flow.given_up))

    def _lap(self) -> None:
        end_ns = self._recording.end_ns
        if self._start_ns > end_ns:
            raise UserError(
                f"{self._settings.bag}: start_offset {self._settings.start_offset:g} s lies behind"
                f" the end, the bag spans {(end_ns - self._recording.start_ns) * 1e-9:.1f} s"
            )
        self._begin_lap()
        progress = Progress(self._start_ns, end_ns)
        span_ns = range(self._start_ns, end_ns + 1)
        for batch in batches(self._recording.messages(self._names, span_ns), BATCH_NS):
            self._wait_while_paused()
            self._send(batch)
            self._serve()
            self._flow.hold()
            if line := progress.at(batch[-1].log_ns):
                self.get_logger().info(line)
        self._flow.drain()
        self._summarise()

    def _begin_lap(self) -> None:
        self._pace.restart()
        self._flow.restart()
        self._clock_ns = 0

    def _start_anew(self) -> None:
        last = [name for name in self._concerned if name not in self._waited_for]
        for name in reset(self, [*self._waited_for, *last][::-1]):
            self.get_logger().warning(f"{name} did not answer its reset")

    def _send(self, batch: list[RawMessage]) -> None:
        for raw in batch:
            self._wait_until_due(raw.log_ns)
            self._tell_time(raw.log_ns)
            if self._output.publish(raw):
                self._published += 1
                self._flow.sent(raw)
            else:
                self._diagnostics.refused["not_a_ros_message"] += 1

    def _wait_until_due(self, log_ns: int) -> None:
        while (delay := self._pace.delay(log_ns)) > _WORTH_WAITING:
            self._executor.spin_once(timeout_sec=min(delay, 0.1))
            self._wait_while_paused()

    def _wait_while_paused(self) -> None:
        while self._is_paused:
            self._executor.spin_once(timeout_sec=0.1)
            self._pace.restart()

    def _tell_time(self, log_ns: int) -> None:
        """Publish the clock, at most every 10 ms of wall time."""
        period_ns = _CLOCK_PERIOD_NS * max(self._settings.rate or 10.0, 1.0)
        if self._time is None or log_ns - self._clock_ns < period_ns:
            return
        self._clock_ns = log_ns
        seconds, nanoseconds = divmod(log_ns, 1_000_000_000)
        time_message = make("builtin_interfaces/msg/Time", sec=seconds, nanosec=nanoseconds)
        self._time.publish(make("rosgraph_msgs/msg/Clock", clock=time_message))

    def _serve(self) -> None:
        for _ in range(_EVENTS):
            self._executor.spin_once(timeout_sec=0.0)

    def _on_pause(self, request: Any, response: Any) -> Any:
        self._is_paused = bool(request.data)
        response.success = True
        response.message = "paused" if self._is_paused else "going on"
        return response

    def _summarise(self) -> None:
        self.get_logger().info(f"replayed {self._published} messages, {self._flow.stalls} stalls")


def _play() -> int:
    node: BagReplay | None = None
    try:
        node = BagReplay()
        node.play()
    finally:
        if node is not None:
            node.destroy_node()
    return 0


def main() -> int:
    """Run the node until the bag is worked off; return its exit code."""
    # A shell that starts it in the background has SIGINT ignored.
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, signal.default_int_handler)
    try:
        # Our own handling of SIGINT keeps the middleware alive until the loop has ended.
        begin()
        return _play()
    except UserError as error:
        print(f"bag_replay: {error}", file=sys.stderr)
        return 1
    except (KeyboardInterrupt, ExternalShutdownException):
        return 0
    finally:
        try_shutdown()


if __name__ == "__main__":
    leave(main())
