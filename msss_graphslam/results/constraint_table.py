# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""constraints.csv: every constraint that was tried, its gates' figures, and why it was refused."""

import csv
import io
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from msss_graphslam.core.types import Constraint
from msss_graphslam.results.atomic import write_text

__all__ = ["write_constraint_table"]

_COLUMNS = (
    "kind",
    "first",
    "second",
    "accepted",
    "refusal",
    "x_m",
    "y_m",
    "yaw_rad",
    "var_x",
    "cov_x_y",
    "cov_x_yaw",
    "var_y",
    "cov_y_yaw",
    "var_yaw",
)


def write_constraint_table(path: Path, constraints: Sequence[Constraint]) -> None:
    """Write one row a constraint, in the order of trial.

    After the fixed columns follows one column for each gate's figure that occurs, by name; it is
    empty where the constraint never came to that gate.
    """
    names = sorted({name for constraint in constraints for name in constraint.figures})
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow([*_COLUMNS, *names])
    table.writerows(_row(constraint, names) for constraint in constraints)
    write_text(path, text.getvalue())


def _row(constraint: Constraint, names: Sequence[str]) -> list[str]:
    numbers = [*constraint.relative_pose, *constraint.covariance[np.triu_indices(3)]]
    return [
        str(constraint.kind),
        str(constraint.first),
        str(constraint.second),
        "yes" if constraint.accepted else "no",
        constraint.refusal,
        *(f"{number:.9g}" for number in numbers),
        *(
            f"{constraint.figures[name]:.9g}" if name in constraint.figures else ""
            for name in names
        ),
    ]
