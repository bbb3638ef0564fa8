# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""``python ear.py NODE KEY``: prints the value under the key of a node's diagnostics."""

import sys
from contextlib import suppress
from typing import Any

import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from rclpy.executors import ExternalShutdownException


def main(name: str, key: str) -> None:
    """Print every value that comes, until a signal ends it."""

    def hear(message: Any) -> None:
        for status in message.status:
            values = {entry.key: entry.value for entry in status.values}
            if status.name.endswith(f"/{name}") and key in values:
                print(key, values[key], flush=True)

    rclpy.init()
    node = rclpy.create_node("ear")
    node.create_subscription(DiagnosticArray, "/diagnostics", hear, 100)
    with suppress(ExternalShutdownException):
        rclpy.spin(node)


if __name__ == "__main__":
    main(*sys.argv[1:])
