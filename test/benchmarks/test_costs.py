# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The tables of costs."""

from pathlib import Path
from subprocess import CalledProcessError

import numpy as np
import pytest
from sample_bags import sensor_messages, write_bag
from synthetic_run import synthetic_run

from benchmarks.bench_tables import growth_table, process_table, stage_table
from benchmarks.cost import STAGES, ProcessCost, ScanCosts, process_cost, scan_costs
from benchmarks.tables import Table
from msss_graphslam.recordings.reader import open_recording


def test_stages_and_the_rest_add_up_to_the_whole() -> None:
    record = synthetic_run()
    *parts, whole = stage_table(record).rows
    shares = [float(row[4]) for row in parts]
    assert whole[0] == "estimation"
    assert float(whole[4]) == 100.0
    assert sum(shares) == pytest.approx(100.0, abs=0.05 * len(shares))
    assert float(whole[3]) == pytest.approx(1e3 * record.cost.wall / 12, abs=0.005)


def test_calls_are_counted() -> None:
    rows = {row[0]: row for row in stage_table(synthetic_run()).rows}
    assert rows["scan matching"][1] == "48"
    assert rows["beam segmentation"][1] == str(12 * 60)


@pytest.mark.parametrize(
    ("estimator", "cpu", "missed"),
    [("uspic", 9.9, False), ("uspic", 10.2, True), ("full", 6.6, False), ("full", 6.7, True)],
)
def test_a_run_too_slow_is_marked(estimator: str, cpu: float, missed: bool) -> None:
    (row,) = process_table({estimator: ProcessCost(cpu, 20.0, 200.0)}, duration=1000.0).rows
    assert row[2].endswith("(missed)") == missed
    (row,) = process_table({estimator: ProcessCost(5.0, cpu, 200.0)}, duration=1000.0).rows
    assert row[4].endswith("(missed)") == missed


@pytest.mark.parametrize(("peak", "missed"), [(499.0, False), (500.0, True)])
def test_a_run_too_large_is_marked(peak: float, missed: bool) -> None:
    (row,) = process_table({"full": ProcessCost(1.0, 1.0, peak)}, duration=1000.0).rows
    assert row[5].endswith("(missed)") == missed


def test_growth_compares_the_same_number_of_last_scans() -> None:
    whole = ScanCosts(dict.fromkeys(STAGES, np.repeat([1e-3, 3e-3], [36, 4])), np.arange(40.0))
    end = ScanCosts(dict.fromkeys(STAGES, np.repeat([9e-3, 2e-3], [4, 4])), np.arange(8.0))
    rows = growth_table("full", few=end, many=whole).rows
    assert [row[0] for row in rows] == ["4", "36"]
    assert [row[1] for row in rows] == ["5.5", "37.5"]
    assert [row[2] for row in rows] == ["2.00", "3.00"]
    assert [row[-1] for row in rows] == ["10.00", "15.00"]


def test_every_scan_of_a_part_is_measured(tmp_path: Path) -> None:
    bag = write_bag(tmp_path / "bag", sensor_messages(450))
    recording = open_recording(bag)
    whole = scan_costs(recording, "full")
    part = scan_costs(recording, "full", 0.5, 1.0)
    assert len(whole.total) == len(whole.tried) > len(part.tried) == 1
    assert (whole.stages["scan_generation"] > 0.0).all()


def test_a_run_that_fails_is_no_measurement(tmp_path: Path) -> None:
    with pytest.raises(CalledProcessError):
        process_cost(tmp_path / "no_such_bag", "full", tmp_path / "out")


def test_markdown_has_a_rule_under_the_header() -> None:
    table = Table("title", ["name", "a", "b"], [["x", "1", "2"]])
    assert table.markdown() == "| name | a | b |\n| --- | ---: | ---: |\n| x | 1 | 2 |"
