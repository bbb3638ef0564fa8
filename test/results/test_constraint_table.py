# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
import csv
from dataclasses import replace

import numpy as np
from synthetic_run import synthetic_run

from msss_graphslam.results.constraint_table import write_constraint_table


def rows_of(path):
    with path.open(newline="") as stream:
        return list(csv.DictReader(stream))


def test_every_tried_constraint_has_a_row_with_its_fate_and_figures(tmp_path):
    constraints = synthetic_run(6).estimate.constraints
    write_constraint_table(tmp_path / "c.csv", constraints)
    rows = rows_of(tmp_path / "c.csv")
    assert len(rows) == len(constraints)
    for row, edge in zip(rows, constraints, strict=True):
        assert row["kind"] == edge.kind
        assert (int(row["first"]), int(row["second"])) == (edge.first, edge.second)
        assert row["refusal"] == edge.refusal
        assert row["accepted"] == ("yes" if edge.accepted else "no")
        np.testing.assert_allclose(
            [float(row[name]) for name in ("x_m", "y_m", "yaw_rad")], edge.relative_pose, rtol=1e-8
        )
        assert float(row["cov_x_y"]) == edge.covariance[0, 1]
        for name in ("mahalanobis", "shape_distance"):
            assert (row[name] != "") == (name in edge.figures)


def test_a_reason_with_commas_and_quotes_survives(tmp_path):
    edge = replace(synthetic_run(3).estimate.constraints[0], refusal='a, "b"\nc')
    write_constraint_table(tmp_path / "c.csv", [edge])
    assert rows_of(tmp_path / "c.csv")[0]["refusal"] == 'a, "b"\nc'


def test_without_constraints_there_is_still_a_header(tmp_path):
    write_constraint_table(tmp_path / "c.csv", [])
    assert (tmp_path / "c.csv").read_text().startswith("kind,first,second,accepted,refusal,")
