# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The end of a session, asked of the nodes by their services; ROS is loaded only then."""

import time
from collections.abc import Sequence
from typing import Any

from msss_graphslam.live.session import Conclude, Progress

__all__ = ["conclude_in"]

_LOOK_EVERY = 0.1
_DISCOVERY = 10.0


def conclude_in(namespace: str) -> Conclude:
    """Return what has the nodes of this namespace save."""

    def conclude(names: Sequence[str], progress: Progress) -> dict[str, str]:
        from msss_graphslam.nodes import conclusion
        from msss_graphslam.ros.visiting import visitor

        doing = [""]

        def note(text: str) -> None:
            doing[0] = text.partition(":")[0]

        with visitor("msss_live", namespace) as node:
            node.create_timer(_LOOK_EVERY, lambda: progress(0.0, doing[0]))
            _await_services(node, [f"/{namespace}/{name}/save" for name in names], progress)
            return conclusion.conclude(node, names, note)

    return conclude


def _await_services(node: Any, names: Sequence[str], progress: Progress) -> None:
    """Wait until the services are known here; a node that died a moment ago may come back."""
    wanted = {name.replace("//", "/") for name in names}
    until = time.monotonic() + _DISCOVERY
    while time.monotonic() < until:
        if wanted <= {name for name, _ in node.get_service_names_and_types()}:
            return
        progress(0.0, "")
        time.sleep(_LOOK_EVERY)
