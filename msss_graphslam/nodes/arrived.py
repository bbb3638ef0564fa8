# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What has arrived but not been taken yet."""

from collections.abc import Iterable
from typing import Any

from msss_graphslam.ros.inputs import Input
from msss_graphslam.ros.qos import LARGEST_DEPTH

__all__ = ["take_arrived"]


def take_arrived(inputs: Iterable[Input]) -> None:
    """Take all messages that wait in the inputs.

    The executor takes one of each topic in turn, so a service may be called long before it comes
    to what was published earlier.
    """
    for subscribed in inputs:
        subscription: Any = subscribed.subscription
        for _ in range(LARGEST_DEPTH):
            taken = subscription.handle.take_message(subscription.msg_type, subscription.raw)
            if taken is None:
                break
            subscription.callback(*taken)
