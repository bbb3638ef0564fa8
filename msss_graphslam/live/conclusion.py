# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The end of a session, asked of the nodes by their services; ROS is loaded only for that."""

import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

from msss_graphslam.live.session import Conclude, Progress

__all__ = ["concluding_in"]

_LOOK_EVERY = 0.1
_DISCOVERY = 10.0


@contextmanager
def concluding_in(namespace: str) -> Iterator[Conclude]:
    """Give what has the nodes of this namespace save; it makes their acquaintance meanwhile."""
    from msss_graphslam.nodes.conclusion import conclude
    from msss_graphslam.ros.visiting import visitor

    with visitor("msss_live", namespace) as node:

        def have_saved(names: Sequence[str], progress: Progress) -> dict[str, str]:
            doing = [""]
            node.create_timer(_LOOK_EVERY, lambda: progress(0.0, doing[0]))

            def note(text: str) -> None:
                doing[0] = text.partition(":")[0]

            _await_services(node, [f"/{namespace}/{name}/save" for name in names], progress)
            return conclude(node, names, note)

        yield have_saved


def _await_services(node: Any, names: Sequence[str], progress: Progress) -> None:
    """Wait until the services are known here; a node that died a moment ago may come back."""
    wanted = {name.replace("//", "/") for name in names}
    until = time.monotonic() + _DISCOVERY
    while time.monotonic() < until:
        if wanted <= {name for name, _ in node.get_service_names_and_types()}:
            return
        progress(0.0, "")
        time.sleep(_LOOK_EVERY)
