# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Nodes as real processes, each test in a domain of its own, and what listens to them."""

import os
import re
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node

__all__ = [
    "LIMIT",
    "Domain",
    "NodeProcess",
    "TestNode",
    "as_yaml",
    "domain",
    "live",
    "wait_until",
]

ROOT = Path(__file__).parents[2]
LIMIT = 180.0


def wait_until(
    condition: Callable[[], Any], what: str = "the condition", limit: float = LIMIT
) -> Any:
    """Return the condition's value once it is true; an AssertionError after the limit [s]."""
    until = time.monotonic() + limit
    while not (value := condition()):
        assert time.monotonic() < until, f"waited {limit} s in vain for {what}"
        time.sleep(0.01)
    return value


class Domain:
    """A ROS domain that nobody else on this machine has taken."""

    def __init__(self, number: int) -> None:
        self.number = number

    @property
    def environment(self) -> dict[str, str]:
        """The variables of a process in this domain."""
        return {
            **os.environ,
            "ROS_DOMAIN_ID": str(self.number),
            "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
            "ROS_PYTHON_CHECK_FIELDS": "1",
            "OMP_NUM_THREADS": "1",
            "PYTHONUNBUFFERED": "1",
        }

    def start(self, node: str, *arguments: str, namespace: str = "", **parameters: Any) -> Any:
        """Start ``msss_graphslam.nodes.<node>``; use the result as a context manager."""
        options = [f"-p{name}:={as_yaml(value)}" for name, value in parameters.items()]
        options = [part for option in options for part in ("-p", option[2:])]
        remapped = ["-r", f"__ns:={namespace}"] if namespace else []
        ros = [*options, *remapped, *arguments]
        command = [sys.executable, "-m", f"msss_graphslam.nodes.{node}"]
        return NodeProcess([*command, "--ros-args", *ros] if ros else command, self)


@contextmanager
def domain() -> Iterator[Domain]:
    """Give a domain; the lock on it goes with the process, however that ends."""
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as lock:
        first = os.getpid() * 7
        for number in (1 + (first + offset) % 60 for offset in range(60)):
            try:
                lock.bind(f"\0msss_graphslam_domain_{number}")
            except OSError:
                continue
            yield Domain(number)
            return
    raise AssertionError("every ROS domain is taken")


class NodeProcess:
    """A process whose output is collected; it is killed at the end if it still runs."""

    def __init__(self, command: list[str], of: Domain) -> None:
        self.command = command
        self._domain = of
        self._lines: list[str] = []

    def __enter__(self) -> Self:
        self._process = subprocess.Popen(
            self.command,
            env=self._domain.environment,
            cwd=ROOT,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            errors="replace",
        )
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self.is_running:
            self._process.kill()
        self._process.wait()
        self._reader.join(5.0)
        if kind is not None:
            print(f"--- {' '.join(self.command[2:])} ---\n{self.output}", file=sys.stderr)

    @property
    def pid(self) -> int:
        return self._process.pid

    @property
    def is_running(self) -> bool:
        return self._process.poll() is None

    @property
    def output(self) -> str:
        return "".join(list(self._lines))

    def wait(self, limit: float = LIMIT) -> int:
        """Return the exit code once it has ended by itself, all its output read."""
        code = self._process.wait(limit)
        self._reader.join(5.0)
        return code

    def wait_for_output(self, pattern: str, limit: float = LIMIT) -> str:
        """Return what in the output matches the pattern, once it does."""
        found = wait_until(
            lambda: re.search(pattern, self.output) or not self.is_running, repr(pattern), limit
        )
        self._reader.join(0.0 if self.is_running else 5.0)
        found = re.search(pattern, self.output)
        assert found, f"{pattern!r} is not in the output:\n{self.output}"
        return found.group()

    def signal(self, number: int) -> None:
        self._process.send_signal(number)

    def interrupt(self, limit: float = LIMIT) -> int:
        """Do as Ctrl-C does; return the exit code."""
        self.signal(signal.SIGINT)
        return self.wait(limit)

    def kill(self) -> None:
        """Kill it as kill -9 does."""
        self._process.kill()
        self._process.wait()

    def _read(self) -> None:
        assert self._process.stdout is not None
        for line in self._process.stdout:
            self._lines.append(line)


def live(of: Domain, *arguments: object) -> NodeProcess:
    """Start ``msss live``; use the result as a context manager."""
    return NodeProcess([sys.executable, "-m", "msss_graphslam", "live", *map(str, arguments)], of)


def _in_the_spinning_thread(method: Callable[..., Any]) -> Any:
    def order(node: "SpunNode", *arguments: Any, **options: Any) -> Any:
        return node.do(partial(method, node, *arguments, **options))

    return order


class SpunNode(Node):
    """A node spun in a thread of its own, in which all that it has is made and taken away.

    rclpy is not made for entities that come and go in one thread while another waits on them.
    """

    create_client = _in_the_spinning_thread(Node.create_client)
    create_publisher = _in_the_spinning_thread(Node.create_publisher)
    create_service = _in_the_spinning_thread(Node.create_service)
    create_subscription = _in_the_spinning_thread(Node.create_subscription)
    create_timer = _in_the_spinning_thread(Node.create_timer)
    destroy_client = _in_the_spinning_thread(Node.destroy_client)

    _thread: threading.Thread | None = None

    def spin(self) -> None:
        """Start to spin, in the executor that has the node."""
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._spin, daemon=True)
        self._thread.start()

    def stop(self) -> None:
        """Stop to spin."""
        assert self._thread is not None
        self._stop.set()
        self._thread.join()

    def do(self, make: Callable[[], Any]) -> Any:
        """Return what this makes in the thread that spins, before and after that in this one."""
        thread = self._thread
        if thread is None or not thread.is_alive() or thread is threading.current_thread():
            return make()
        made: Future[Any] = Future()
        self.executor.create_task(_fulfil, made, make)
        return made.result(LIMIT)

    def _spin(self) -> None:
        while not self._stop.is_set():
            self.executor.spin_once(timeout_sec=0.05)


def _fulfil(made: Future[Any], make: Callable[[], Any]) -> None:
    try:
        made.set_result(make())
    except Exception as error:
        made.set_exception(error)


class TestNode:
    """A node in the test's own process, spun in a thread, in a domain."""

    __test__ = False

    def __init__(self, of: Domain, name: str = "test", namespace: str = "/") -> None:
        os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
        self.context = rclpy.Context()
        rclpy.init(context=self.context, domain_id=of.number)
        self.node = SpunNode(name, namespace=namespace, context=self.context)
        self.executor = SingleThreadedExecutor(context=self.context)
        self.executor.add_node(self.node)

    def __enter__(self) -> Self:
        self.node.spin()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.node.stop()
        self.executor.shutdown()
        self.node.destroy_node()
        rclpy.shutdown(context=self.context)

    def call(self, kind: Any, service: str, limit: float = LIMIT, **fields: Any) -> Any:
        """Return the answer of a service."""
        client = self.node.create_client(kind, service)
        try:
            wait_until(client.service_is_ready, f"service {service}", limit)
            future = client.call_async(kind.Request(**fields))
            wait_until(future.done, f"an answer of {service}", limit)
            return future.result()
        finally:
            self.node.destroy_client(client)


def as_yaml(value: Any) -> str:
    """Return a parameter's value as ROS's command line takes it."""
    if isinstance(value, bool):
        return str(value).lower()
    return str(value)
