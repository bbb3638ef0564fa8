# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""How a replay ends: nodes that save, laps, interrupts, and bags that cannot be replayed."""

import threading
from pathlib import Path
from typing import Any

import pytest
from nodes.processes import LIMIT, Domain, TestNode, wait_until
from nodes.replay_listener import TRIGGER, Listener, recorded, replay
from sample_bags import write_bag

pytestmark = pytest.mark.slow


def test_at_the_end_each_node_saves_when_it_is_through(tmp_path: Path, at: Domain) -> None:
    bag = write_bag(tmp_path / "dive")
    listener = Listener(at)
    listener.answer("back_end/save")
    listener.answer("dead_reckoning/save", refusals=2)
    with listener, replay(at, bag, conclude=True) as process:
        assert process.wait() == 0
        assert listener.called == ["dead_reckoning/save"] * 3 + ["back_end/save"]
        assert "dead_reckoning is done: call 3" in process.output
        assert listener.count == 250


def test_a_node_that_is_started_again_while_it_saves_is_asked_again(
    tmp_path: Path, at: Domain
) -> None:
    bag = write_bag(tmp_path / "dive")
    asked, over = threading.Event(), threading.Event()

    def hang(_: Any, response: Any) -> Any:
        """Take the question and give no answer, as one that has died."""
        asked.set()
        over.wait()
        return response

    with Listener(at) as listener, TestNode(at, "first") as first:
        listener.answer("dead_reckoning/save")
        first.node.create_service(TRIGGER, "back_end/save", hang)
        with replay(at, bag, conclude=True) as process:
            assert asked.wait(LIMIT)
            listener.answer("back_end/save")
            code = process.wait()
            over.set()
        assert code == 0
        assert listener.called == ["dead_reckoning/save", "back_end/save"]
        assert "back_end is done: call 1" in process.output


def test_each_lap_begins_with_a_reset_from_the_end_to_the_beginning(
    tmp_path: Path, at: Domain
) -> None:
    bag = write_bag(tmp_path / "dive")
    listener = Listener(at)
    for name in ("dead_reckoning", "front_end", "back_end"):
        listener.answer(f"{name}/reset")
    with listener, replay(at, bag, loop=True) as process:
        wait_until(lambda: listener.count >= 500, "two laps")
        assert process.interrupt() == 0
        assert listener.called[:3] == ["back_end/reset", "front_end/reset", "dead_reckoning/reset"]
        pings = listener.received["sonar/ping"]
        assert pings[:100] == recorded(bag)["sonar/ping"] * 2


@pytest.mark.parametrize("wait_for", ["[dead_reckoning]", "['']"])
def test_an_interrupt_ends_it_cleanly(tmp_path: Path, at: Domain, wait_for: str) -> None:
    bag = write_bag(tmp_path / "dive")
    with TestNode(at) as other, replay(at, bag, rate=0.01, wait_for=wait_for) as process:
        wait_until(lambda: other.node.count_publishers("sonar/ping"), "the publisher")
        assert process.interrupt(5.0) == 0
        assert "Traceback" not in process.output


@pytest.mark.parametrize(
    ("parameters", "complaint"),
    [
        ({"bag": "nowhere"}, "nowhere: no such file or folder"),
        ({"bag": "''"}, "parameter bag is missing"),
        ({"topics": "[camera]"}, "no topic camera, only /dvl/twist"),
        ({"start_offset": 2.5}, "start_offset 2.5 s lies behind the end, the bag spans 2.0 s"),
        ({"rate": -1.0}, "parameter rate is -1.0, must be a number of at least 0"),
        ({"rate": "fast"}, "parameter rate is 'fast'"),
    ],
)
def test_what_cannot_be_replayed_is_told_in_one_line(
    tmp_path: Path, at: Domain, parameters: dict[str, Any], complaint: str
) -> None:
    bag = write_bag(tmp_path / "dive")
    options = {"bag": bag, "wait_for": "['']", **parameters}
    with at.start("bag_replay", **options) as process:
        assert process.wait() == 1
        assert complaint in process.output
        assert len(process.output.splitlines()) == 1
