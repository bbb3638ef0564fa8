# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""A head's bytes at real time, on a pseudo-terminal or a topic."""

import os
import threading
import time
import tty
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import replace
from pathlib import Path

import numpy as np

from benchmarks.micron_stream import head_data
from msss_graphslam.messages import encoding, topics
from msss_graphslam.micron.packets import TURN, HeadData

__all__ = ["BAUDRATE", "BINS", "RATE", "feed_a_terminal", "feed_a_topic"]

RATE = 25.0
BINS = 400
_STEP = 30
BAUDRATE = 115200
_BYTES_A_SECOND = BAUDRATE // 10
_TICK = 0.001


@contextmanager
def feed_a_terminal() -> Iterator[Path]:
    """Write packets to a pseudo-terminal, at the speed of a line; give its path."""
    head, driver = os.openpty()
    tty.setraw(driver)
    os.set_blocking(head, False)
    with _running(lambda stop: _trickle(head, stop)):
        yield Path(os.ttyname(driver))
    os.close(head)
    os.close(driver)


@contextmanager
def feed_a_topic() -> Iterator[None]:
    """Publish a packet a message on ``sonar/raw``."""
    from msss_graphslam.ros.messages import make, message_class
    from msss_graphslam.ros.qos import profile_of
    from msss_graphslam.ros.visiting import visitor

    with visitor("benchmark_head", "") as node:
        topic = topics.SONAR_RAW
        kind = message_class(topic.type_name)
        publisher = node.create_publisher(kind, topic.name, profile_of(topic))

        def publish(stop: threading.Event) -> None:
            for packet in _packets(stop):
                publisher.publish(encoding.raw_bytes(make, packet, time.time_ns()))

        with _running(publish):
            yield


def _trickle(head: int, stop: threading.Event) -> None:
    for packet in _packets(stop):
        begun, sent = time.monotonic(), 0
        while sent < len(packet):
            time.sleep(_TICK)
            arrived = min(int((time.monotonic() - begun) * _BYTES_A_SECOND), len(packet))
            with suppress(BlockingIOError):
                sent += os.write(head, packet[sent:arrived]) if arrived > sent else 0
        with suppress(BlockingIOError):
            os.read(head, 4096)


def _packets(stop: threading.Event) -> Iterator[bytes]:
    """Yield packets when they are due, until the end."""
    index, begun = 0, time.monotonic()
    while not stop.wait(max(begun + index / RATE - time.monotonic(), 0.0)):
        yield _packet(index).frame().encode()
        index += 1


def _packet(index: int) -> HeadData:
    codes = np.random.default_rng(index).integers(0, 256, BINS).astype(np.uint8)
    beam = head_data(codes.tobytes(), (index * _STEP) % TURN)
    return replace(beam, range_scale=200, ad_interval=104, step=_STEP)


@contextmanager
def _running(work: Callable[[threading.Event], None]) -> Iterator[None]:
    stop = threading.Event()
    thread = threading.Thread(target=work, args=(stop,), daemon=True)
    thread.start()
    try:
        yield
    finally:
        stop.set()
        thread.join()
