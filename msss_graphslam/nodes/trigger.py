# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""A service of another node, called also where that is started again meanwhile."""

import time
from collections.abc import Callable
from typing import Any

from rclpy.node import Node

from msss_graphslam.ros.messages import message_class

__all__ = ["Spin", "Trigger"]

Spin = Callable[[float], None]
"""Spins the node for at most so many seconds."""

_KIND = "std_srvs/srv/Trigger"
_GONE = 2.0
_LOOK_EVERY = 0.5


class Trigger:
    """A ``std_srvs/Trigger``; ``close`` ends it."""

    def __init__(self, node: Node, name: str, spin: Spin) -> None:
        self._node = node
        self._spin = spin
        self._client = node.create_client(message_class(_KIND), name)

    @property
    def is_ready(self) -> bool:
        """Whether somebody offers the service."""
        return self._client.service_is_ready()

    def close(self) -> None:
        """Take back what the node has for it."""
        self._node.destroy_client(self._client)

    def call(self, bound: float) -> Any:
        """Return the answer, or None where none comes within so many seconds.

        Nor does one come where the service has vanished. A node that was started again knows
        nothing of the question, and is asked anew.
        """
        future, asked = self._ask()
        until = time.monotonic() + bound
        seen = looked = time.monotonic()
        while not future.done():
            self._spin(0.05)
            now = time.monotonic()
            seen = now if self.is_ready else seen
            if now > until or now - seen > _GONE:
                self._client.remove_pending_request(future)
                return None
            if now - looked > _LOOK_EVERY:
                looked = now
                if self._servers() - asked:
                    self._client.remove_pending_request(future)
                    future, asked = self._ask()
        return future.result()

    def _ask(self) -> tuple[Any, frozenset[bytes]]:
        """Call; return the future, and those who may have got the request."""
        servers = self._servers()
        return self._client.call_async(message_class(_KIND).Request()), servers

    def _servers(self) -> frozenset[bytes]:
        """Return who offers the service; nobody where the middleware names topics otherwise."""
        name = f"rq{self._client.service_name}Request"
        found = self._node.get_subscriptions_info_by_topic(name, no_mangle=True)
        return frozenset(bytes(endpoint.endpoint_gid) for endpoint in found)
