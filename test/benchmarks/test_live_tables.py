# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The figures of the live nodes, and the tables that show them."""

import pytest

from benchmarks.live_figures import (
    Percentiles,
    answer_times,
    complete_at,
    lost_messages,
    percentiles,
    turn_times,
)
from benchmarks.live_tables import (
    Latency,
    NodeUsage,
    Replay,
    Traffic,
    bandwidth_table,
    latency_table,
    replay_cost_table,
    replay_table,
    usage_table,
)
from benchmarks.live_usage import Memory, cpu_ticks, memory_of

MS = 1_000_000
REPLAYS = [
    Replay(20.0, 19.9, 70.0, 0, True, 500.0, {"front_end": 2.0, "back_end": 3.0}),
    Replay(0.0, 19.0, 71.0, 1, False, 1000.0, {"front_end": 5.0, "bag_replay": 1.0}),
]


def test_an_answer_is_the_first_that_is_not_older() -> None:
    asked = {100: 1000 * MS, 101: 1001 * MS, 120: 1020 * MS}
    times = answer_times(asked, stamps=[100, 120], received=[1003 * MS, 1024 * MS])
    assert times == pytest.approx([0.003, 0.023, 0.004])


def test_an_input_that_nothing_answers_is_left_out() -> None:
    assert len(answer_times({100: 0, 130: 0}, stamps=[100, 120], received=[1, 2])) == 1


def test_an_answer_may_need_two_inputs() -> None:
    beams = {100: 5, 110: 30, 130: 40}
    assert complete_at(beams, {120: 20, 100: 9}) == {100: 9, 110: 30}


def test_a_turn_is_timed_from_its_last_beam_to_a_graph_that_holds_it() -> None:
    sent = {190: 2000 * MS, 290: 3000 * MS}
    times = turn_times({100: 190, 200: 290}, sent, stamps=[200], received=[3100 * MS])
    assert times == pytest.approx([1.1, 0.1])


def test_a_turn_whose_last_beam_was_not_heard_is_left_out() -> None:
    assert len(turn_times({100: 190}, {191: 0}, stamps=[100], received=[1])) == 0


def test_p99_is_a_time_that_was_measured() -> None:
    times = percentiles([0.001] * 98 + [0.5, 0.7])
    assert times == Percentiles(100, 0.001, 0.7)
    assert percentiles([0.001] * 199 + [0.7]).p99 == 0.001
    with pytest.raises(ValueError, match="nothing was measured"):
        percentiles([])


def test_losses_of_all_nodes_are_summed() -> None:
    rows = {
        "/dead_reckoning": {"lost/imu/data": "2", "lost/sonar/ping": "0", "gaps/imu/data": "7"},
        "/back_end": {"lost/pose": "3", "refused/lost": "9"},
    }
    assert lost_messages(rows) == 5


def test_cpu_time_is_read_past_a_name_with_spaces_and_brackets() -> None:
    stat = "12 (a) b (c) S 1 12 12 0 -1 4194304 1 2 3 4 250 50 7 8 20 0 3 0 999"
    assert cpu_ticks(stat) == 300


def test_memory_is_read_in_mebibytes() -> None:
    rollup = "5600-7ff [rollup]\nRss:  2048 kB\nPss:  1024 kB\nPss_Dirty:  4 kB\n"
    assert memory_of(rollup) == Memory(rss=2.0, pss=1.0)


@pytest.mark.parametrize(("cpu", "missed"), [(17.5, False), (17.6, True)])
def test_only_nodes_of_the_vehicle_count(cpu: float, missed: bool) -> None:
    usage = {
        "front_end": NodeUsage(cpu, Memory(100.0, 50.0)),
        "back_end": NodeUsage(17.5, Memory(200.0, 60.0)),
        "bag_replay": NodeUsage(90.0, Memory(900.0, 900.0), counted=False),
    }
    *_, replay, total = usage_table("", usage).rows
    assert replay[0] == "bag_replay (not counted)"
    assert total[1].endswith("(missed)") == missed
    assert total[2:] == ["300", "110"]


def test_too_much_memory_is_marked() -> None:
    total = usage_table("", {"back_end": NodeUsage(1.0, Memory(601.0, 600.0))}).rows[-1]
    assert total[2:] == ["601 (missed)", "600"]


def test_each_latency_is_held_against_its_own_bars() -> None:
    times = Percentiles(100, 0.006, 0.020)
    rows = latency_table("", [Latency("a, b", times, 0.005, 0.025), Latency("c, d", times)]).rows
    assert rows[0] == ["a, b", "100", "6.0 (missed) (≤ 5)", "20.0 (≤ 25)"]
    assert rows[1] == ["c, d", "100", "6.0", "20.0"]


def test_a_replay_that_is_slow_loses_or_differs_is_marked() -> None:
    rows = replay_table(REPLAYS).rows
    assert rows[0] == ["20", "19.9", "70.0", "0", "yes"]
    assert rows[1] == ["as fast as it goes", "19.0 (missed)", "71.0", "1 (missed)", "no (missed)"]


def test_cost_of_a_replay_is_that_of_1000_s_of_mission() -> None:
    table = replay_cost_table(REPLAYS)
    assert list(table.header) == ["node", "20", "as fast as it goes"]
    assert table.rows == [
        ["front_end", "4.0", "5.0"],
        ["back_end", "6.0", "0.0"],
        ["bag_replay", "0.0", "1.0"],
        ["all", "10.0", "6.0"],
    ]


def test_bandwidth_is_sorted_and_summed_for_a_topside_back_end() -> None:
    traffic = {
        "pose": Traffic(20, 2000),
        "sonar/ping": Traffic(10, 50_000),
        "scan/beams": Traffic(1, 9000),
        "dvl/twist": Traffic(0, 0),
    }
    rows = bandwidth_table(traffic, 10.0).rows
    assert [row[0] for row in rows[:-1]] == ["sonar/ping", "scan/beams", "pose"]
    assert rows[0] == ["sonar/ping", "1.00", "5000", "5000", ""]
    assert rows[2] == ["pose", "2.00", "100", "200", "yes"]
    assert rows[-1][3] == "1100"
