# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The end of a run: every node works off what it holds and saves; or starts anew."""

import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import partial

from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node

from msss_graphslam.nodes.trigger import Spin, Trigger

__all__ = ["conclude", "reset"]

# How long services are looked for [s], and those of nodes that are known to be there.
_DISCOVERY = 1.0
_LONG_DISCOVERY = 6.0
_AGAIN = 0.02
_RESET = 10.0

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
    with _triggers(node, names, "save") as (triggers, spin):
        return {
            name: _insist(trigger, spin, partial(_tell, progress, name), bound)
            for name, trigger in triggers.items()
        }


def reset(node: Node, names: Sequence[str]) -> list[str]:
    """Call ``reset`` of each node that is there; return those that did not answer."""
    with _triggers(node, names, "reset") as (triggers, _):
        answers = {name: trigger.call(_RESET) for name, trigger in triggers.items()}
    return [name for name, answer in answers.items() if answer is None]


def _tell(progress: Tell, name: str, message: str) -> None:
    progress(f"{name}: {message}")


def _insist(trigger: Trigger, spin: Spin, progress: Tell, bound: float) -> str:
    until = time.monotonic() + bound
    message = ""
    while (left := until - time.monotonic()) > 0.0:
        answer = trigger.call(left)
        if answer is None:
            return f"no answer; last: {message}" if message else "no answer"
        if answer.success:
            return str(answer.message)
        if answer.message != message:
            message = str(answer.message)
            progress(message)
        _spin_for(spin, _AGAIN)
    return f"not through after {bound:.0f} s: {message}"


@contextmanager
def _triggers(
    node: Node, names: Sequence[str], service: str
) -> Iterator[tuple[dict[str, Trigger], Spin]]:
    """Give the services that are there, and what spins meanwhile."""
    with _spinning(node) as spin:
        triggers = {name: Trigger(node, f"{name}/{service}", spin) for name in names}
        try:
            yield _present(node, triggers, spin), spin
        finally:
            for trigger in triggers.values():
                trigger.close()


def _present(node: Node, triggers: dict[str, Trigger], spin: Spin) -> dict[str, Trigger]:
    began = time.monotonic()
    while missing := [name for name, trigger in triggers.items() if not trigger.is_ready]:
        lasting = time.monotonic() - began
        if lasting > (_LONG_DISCOVERY if _is_known(node, missing) else _DISCOVERY):
            break
        _spin_for(spin, 0.05)
    return {name: trigger for name, trigger in triggers.items() if name not in missing}


def _is_known(node: Node, names: Sequence[str]) -> bool:
    """Whether one of the names is that of a node in the same namespace."""
    here = node.get_namespace()
    known = {name for name, where in node.get_node_names_and_namespaces() if where == here}
    return not known.isdisjoint(names)


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
