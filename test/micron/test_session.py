# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The conversation with a head: its start, its faults, its changes of mind."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from micron.packet_makers import REPLIES
from micron.scripted_head import READY, RECENTRING, SECOND, SENT, START_NS, Bench, ScriptedHead

from benchmarks.micron_stream import head_data
from msss_graphslam.config.groups import Micron
from msss_graphslam.micron.head_driver import HeadDriver
from msss_graphslam.micron.packets import (
    Alive,
    HeadCommand,
    HeadStatus,
    Reboot,
    Reply,
    SendData,
    SendUserData,
    SendVersion,
)
from msss_graphslam.micron.requests import Requests
from msss_graphslam.micron.session import Session
from msss_graphslam.micron.settings import HeadSettings
from msss_graphslam.micron.stages import HeadState

SETTINGS = HeadSettings(Micron(range_m=10.0, bins=200))


def opened(head: ScriptedHead | None = None, parameters: Micron = SETTINGS.parameters) -> Bench:
    bench = Bench(HeadDriver(HeadSettings(parameters)), head or ScriptedHead())
    bench.driver.opened(bench.now_ns)
    return bench


def scanning(head: ScriptedHead | None = None) -> Bench:
    bench = opened(head)
    bench.run(8.0)
    assert bench.driver.state is HeadState.SCANNING
    assert len(bench.beams) > 20
    return bench


@pytest.mark.parametrize("head_type", ["dst", "seaking"])
@pytest.mark.parametrize("replies", [1, 2])
def test_the_start_goes_by_the_book(head_type: str, replies: int) -> None:
    bench = opened(ScriptedHead(replies=replies), replace(Micron(), head_type=head_type))
    bench.run(10.0)
    kinds = list(dict.fromkeys(type(packet) for packet in bench.head.heard))
    assert kinds == [Reboot, SendVersion, SendUserData, HeadCommand, SendData]
    (command,) = bench.head.heard_of(HeadCommand)
    assert isinstance(command, HeadCommand)
    assert command.head_type == {"dst": 0x11, "seaking": 0x02}[head_type]
    assert bench.driver.status.beams_a_request == replies
    assert bench.driver.status.full_duplex is (replies == 2)
    assert bench.driver.status.counts["timeouts"] == 0


@pytest.mark.parametrize("replies", [1, 2])
def test_the_head_is_never_idle_and_never_flooded(replies: int) -> None:
    bench = scanning(ScriptedHead(replies=replies))
    before = len(bench.beams)
    asked = len(bench.head.heard_of(SendData))
    bench.run(10.0)
    beams, requests = len(bench.beams) - before, len(bench.head.heard_of(SendData)) - asked
    assert beams == pytest.approx(10.0 / 0.043, abs=4)
    assert requests == pytest.approx(beams / replies, abs=3)
    steps = np.diff([beam.stamp_ns for _, beam in bench.beams[before:]]) * 1e-6
    assert np.abs(steps - 43.0).max() < 3.0


def test_a_head_that_takes_thirty_seconds_to_centre_is_waited_for() -> None:
    bench = opened(ScriptedHead(centring_ns=29 * SECOND))
    bench.run(33.0)
    assert bench.beams
    assert len(bench.head.heard_of(Reboot)) == 1


def test_a_head_that_is_not_there_is_asked_again_and_found_when_it_comes() -> None:
    bench = opened(ScriptedHead(mute=True))
    bench.run(60.0)
    assert bench.driver.state is HeadState.REBOOTING
    assert 4 <= len(bench.head.heard_of(Reboot)) <= 8
    bench.head.mute = False
    bench.run(16.0)
    assert bench.driver.state is HeadState.SCANNING


def test_f5_reset_in_mid_turn() -> None:
    bench = scanning()
    reset_ns = bench.now_ns
    bench.head.restart(reset_ns)
    bench.run(10.0)
    assert bench.since(bench.head.ready_ns)[0][0] - bench.head.ready_ns < 3 * SECOND
    assert not [when for when, _ in bench.since(reset_ns) if when < bench.head.ready_ns]
    counts = bench.driver.status.counts
    assert (counts["resets"], counts["partial_turns"]) == (1, 1)
    assert len(bench.head.heard_of(HeadCommand)) == 2
    assert len(bench.head.heard_of(Reboot)) == 1


@pytest.mark.parametrize(
    ("status", "name"),
    [(HeadStatus.MOTOR_ERROR, "motor_errors"), (HeadStatus.POWER_LOSS, "resets")],
)
def test_a_beam_with_a_fault_is_none_and_parameters_are_sent_again(
    status: HeadStatus, name: str
) -> None:
    bench = scanning()
    beams = len(bench.beams)
    bench.feed(replace(bench.head.beam(), status=status).frame().encode())
    assert len(bench.beams) == beams
    bench.run(4.0)
    assert bench.driver.status.counts[name] == 1
    assert bench.driver.status.counts["partial_turns"] == 1
    assert len(bench.head.heard_of(HeadCommand)) == 2
    assert len(bench.beams) > beams + 20


def test_a_lost_request_is_repeated() -> None:
    bench = scanning()
    bench.connected = False
    bench.run(0.3)
    bench.connected = True
    start_ns = bench.now_ns
    bench.run(1.0)
    assert bench.since(start_ns)[0][0] - start_ns < 0.5 * SECOND
    assert bench.driver.status.counts["timeouts"] == 1
    assert len(bench.head.heard_of(HeadCommand)) == 1


def test_five_timeouts_bring_the_parameters_and_further_silence_a_reboot() -> None:
    bench = scanning()
    bench.head.mute = True
    five = 5 * SETTINGS.reply_timeout
    bench.run(five - 0.2)
    assert len(bench.head.heard_of(HeadCommand)) == 1
    bench.run(0.4)
    assert len(bench.head.heard_of(HeadCommand)) == 2
    assert len(bench.head.heard_of(Reboot)) == 1
    bench.run(10.0)
    assert len(bench.head.heard_of(Reboot)) == 2
    bench.head.mute = False
    start_ns = bench.now_ns
    bench.run(16.0)
    assert bench.since(start_ns)


def test_a_slow_head_is_given_its_time() -> None:
    parameters = Micron(range_m=100.0, bins=800, step_deg=7.2)
    slow = HeadSettings(parameters)
    assert slow.reply_timeout > SETTINGS.reply_timeout
    bench = opened(ScriptedHead(period_ns=round(slow.beam_period * 1e9)), parameters)
    bench.run(10.0)
    assert bench.driver.status.counts["timeouts"] == 0


def test_new_settings_reach_the_head_on_the_open_line() -> None:
    bench = scanning()
    bench.driver.configure(HeadSettings(Micron(range_m=5.0, bins=100)))
    bench.run(3.0)
    assert bench.driver.state is HeadState.SCANNING
    assert len(bench.beams[-1][1].ranges) == 100
    assert bench.driver.status.counts["partial_turns"] == 1
    assert len(bench.head.heard_of(Reboot)) == 1


def test_settings_that_the_head_need_not_know_leave_the_turn_alone() -> None:
    bench = scanning()
    bench.driver.configure(HeadSettings(replace(SETTINGS.parameters, frame_id="head")))
    bench.run(1.0)
    assert bench.driver.status.counts["partial_turns"] == 0
    assert len(bench.head.heard_of(HeadCommand)) == 1


def test_parameters_that_a_head_does_not_take_are_sent_again_but_not_for_ever() -> None:
    bench = scanning()
    bench.head.takes_parameters = False
    bench.driver.configure(HeadSettings(Micron(range_m=5.0, bins=100)))
    bench.run(20.0)
    assert len(bench.head.heard_of(HeadCommand)) == 4
    assert bench.driver.status.counts["parameters_not_taken"] == 2
    assert bench.driver.state is HeadState.SCANNING


def test_a_line_that_comes_back_needs_no_reboot() -> None:
    bench = scanning()
    bench.driver.closed(bench.now_ns)
    bench.connected = False
    bench.run(20.0)
    bench.connected = True
    start_ns = bench.now_ns
    bench.driver.opened(start_ns)
    bench.run(1.0)
    assert bench.since(start_ns)[0][0] - start_ns < 0.5 * SECOND
    assert len(bench.head.heard_of(Reboot)) == 1
    assert bench.driver.status.counts["partial_turns"] == 1


def test_a_head_without_parameters_behind_the_line_that_comes_back_gets_them() -> None:
    bench = scanning()
    bench.driver.closed(bench.now_ns)
    bench.head.restart(bench.now_ns)
    bench.now_ns += 20 * SECOND
    start_ns = bench.now_ns
    bench.driver.opened(start_ns)
    bench.run(6.0)
    assert bench.since(start_ns)


def test_a_clock_that_is_set_back_does_not_stop_the_session() -> None:
    session = Session(SETTINGS)
    session.opened(START_NS)
    assert session.due(START_NS)
    back_ns = START_NS - 3600 * SECOND
    assert session.due(back_ns) == []
    assert session.next_ns is not None
    assert session.next_ns <= back_ns + 10 * SECOND
    assert session.due(session.next_ns) == [Reboot().frame().encode()]


def test_a_closed_session_wants_nothing() -> None:
    session = Session(SETTINGS)
    assert session.next_ns is None
    session.receive(Alive(READY), START_NS)
    assert session.due(START_NS) == []
    assert session.counts == {"unexpected_packets": 1}


def test_what_the_head_said_before_it_rebooted_does_not_count() -> None:
    session = Session(SETTINGS)
    session.opened(START_NS)
    session.receive(Alive(READY), START_NS + SECOND // 4)
    assert session.state is HeadState.REBOOTING
    session.receive(Alive(RECENTRING), START_NS + SECOND)
    assert session.state is HeadState.CENTRING
    session.receive(Alive(READY), START_NS + 2 * SECOND)
    assert session.state is HeadState.IDENTIFYING


def test_an_alive_of_a_head_about_to_be_ready_is_no_reset() -> None:
    bench = scanning()
    bench.feed(Alive(SENT).frame().encode())
    assert bench.driver.state is HeadState.SCANNING


EVENTS = st.lists(
    st.tuples(
        st.one_of(REPLIES, st.sampled_from([Alive(READY), Alive(RECENTRING), head_data(b"12")])),
        st.integers(-2 * SECOND, 20 * SECOND),
        st.sampled_from(["receive", "receive", "receive", "open", "close", "configure"]),
    ),
    max_size=60,
)


@settings(max_examples=60, deadline=None)
@given(events=EVENTS)
def test_no_packet_at_any_time_stops_the_session(
    events: list[tuple[Reply, int, str]],
) -> None:
    bench = opened()
    actions: dict[str, Callable[[], None]] = {
        "open": lambda: bench.driver.opened(bench.now_ns),
        "close": lambda: bench.driver.closed(bench.now_ns),
        "configure": lambda: bench.driver.configure(HeadSettings(Micron(bins=100))),
    }
    for packet, pause_ns, action in events:
        bench.now_ns += pause_ns
        if action == "receive":
            bench.feed(packet.frame().encode())
        else:
            actions[action]()
        assert len(bench.driver.due(bench.now_ns)) <= 16
    bench.driver.closed(bench.now_ns)
    bench.head.restart(bench.now_ns)
    bench.driver.opened(bench.now_ns)
    start_ns = bench.now_ns
    bench.run(40.0)
    assert bench.driver.state is HeadState.SCANNING
    assert bench.since(start_ns)


def test_requests_forget_that_two_beams_came() -> None:
    requests = Requests()
    requests.find_out()
    requests.asked()
    assert not requests.answered()
    assert not requests.answered()
    assert requests.heard_out()
    assert requests.a_request_brings == 2
    requests.go_on()
    assert (requests.a_request_brings, requests.listening) == (1, True)
    assert not requests.heard_out()
