# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The end of a run: every node works off what it holds and saves; or starts anew."""

import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from typing import Any

from rclpy.client import Client
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node

from msss_graphslam.ros.messages import message_class

__all__ = ["WORKING_ORDER", "conclude", "reset"]

WORKING_ORDER = ("dead_reckoning", "scan_generation", "front_end", "back_end")
"""The nodes in the order in which data goes through them."""

_TRIGGER = "std_srvs/srv/Trigger"
_DISCOVERY = 1.0
_AGAIN = 0.1
_GONE = 2.0
_RESET = 10.0

Spin = Callable[[float], None]
Tell = Callable[[str], None]


def conclude(
    node: Node, names: Sequence[str], progress: Tell, bound: float = 300.0
) -> dict[str, str]:
    """Call ``save`` of each node, again and again until it says that it is through.

    Parameters
    ----------
    node
        Any node; its executor is spun meanwhile.
    names
        Names of nodes in its namespace; those that are not there are left out.
    progress
        Told what a node is still busy with.
    bound
        How long [s] each may take.

    Returns
    -------
    dict
        The last message of each node that was there.
    """
    with _clients(node, names, "save") as (clients, spin):
        return {
            name: _insist(client, spin, partial(_tell, progress, name), bound)
            for name, client in clients.items()
        }


def reset(node: Node, names: Sequence[str]) -> list[str]:
    """Call ``reset`` of each node that is there; return those that did not answer."""
    with _clients(node, names, "reset") as (clients, spin):
        answers = {name: _call(client, spin, _RESET) for name, client in clients.items()}
    return [name for name, answer in answers.items() if answer is None]


def _tell(progress: Tell, name: str, message: str) -> None:
    progress(f"{name}: {message}")


def _insist(client: Client, spin: Spin, progress: Tell, bound: float) -> str:
    until = time.monotonic() + bound
    message = ""
    while (left := until - time.monotonic()) > 0.0:
        answer = _call(client, spin, left)
        if answer is None:
            return f"no answer; last: {message}" if message else "no answer"
        if answer.success:
            return str(answer.message)
        if answer.message != message:
            message = str(answer.message)
            progress(message)
        _spin_for(spin, _AGAIN)
    return f"not through after {bound:.0f} s: {message}"


def _call(client: Client, spin: Spin, bound: float) -> Any:
    """Return the answer, or None where none comes or the service vanishes."""
    future: Any = client.call_async(message_class(_TRIGGER).Request())
    until = time.monotonic() + bound
    seen = time.monotonic()
    while not future.done():
        spin(0.05)
        now = time.monotonic()
        seen = now if client.service_is_ready() else seen
        if now > until or now - seen > _GONE:
            client.remove_pending_request(future)
            return None
    return future.result()


@contextmanager
def _clients(
    node: Node, names: Sequence[str], service: str
) -> Iterator[tuple[dict[str, Client], Spin]]:
    """Give the clients of the services that are there, and what spins meanwhile."""
    clients = {
        name: node.create_client(message_class(_TRIGGER), f"{name}/{service}") for name in names
    }
    try:
        with _spinning(node) as spin:
            yield _present(clients, spin), spin
    finally:
        for client in clients.values():
            node.destroy_client(client)


def _present(clients: dict[str, Client], spin: Spin) -> dict[str, Client]:
    until = time.monotonic() + _DISCOVERY
    while time.monotonic() < until:
        if all(client.service_is_ready() for client in clients.values()):
            break
        _spin_for(spin, 0.05)
    return {name: client for name, client in clients.items() if client.service_is_ready()}


@contextmanager
def _spinning(node: Node) -> Iterator[Spin]:
    if node.executor is not None:
        yield node.executor.spin_once
        return
    executor = SingleThreadedExecutor(context=node.context)
    executor.add_node(node)
    try:
        yield executor.spin_once
    finally:
        executor.remove_node(node)
        executor.shutdown()


def _spin_for(spin: Spin, seconds: float) -> None:
    until = time.monotonic() + seconds
    while (left := until - time.monotonic()) > 0.0:
        spin(left)
