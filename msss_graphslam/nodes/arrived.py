# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What has arrived but not been taken yet."""

from collections.abc import Iterable, Sequence
from typing import Any

from msss_graphslam.ros.inputs import Input
from msss_graphslam.ros.qos import LARGEST_DEPTH

__all__ = ["Gathering", "take_arrived"]

# So many of each topic before anything else has its turn.
_MOST_AT_ONCE = 20


def take_arrived(inputs: Iterable[Input], most: int = LARGEST_DEPTH) -> None:
    """Take all messages that wait in the inputs, at most so many of each.

    The executor takes one of each topic in turn, so a service may be called long before it comes
    to what was published earlier.
    """
    for subscribed in inputs:
        subscription: Any = subscribed.subscription
        for _ in range(most):
            taken = subscription.handle.take_message(subscription.msg_type, subscription.raw)
            if taken is None:
                break
            subscription.callback(*taken)


class Gathering:
    """Takes with one message those that have arrived behind it, on some inputs of a node.

    The executor waits anew for each, which costs more than what most of them are good for.
    """

    def __init__(self) -> None:
        self.inputs: Sequence[Input] = ()
        self._is_going_on = False

    def take(self) -> bool:
        """Take what has arrived; return False where that is what a message is taken for."""
        if self._is_going_on:
            return False
        self._is_going_on = True
        try:
            take_arrived(self.inputs, _MOST_AT_ONCE)
        finally:
            self._is_going_on = False
        return True
