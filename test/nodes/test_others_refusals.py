# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What other nodes have refused, as they say on /diagnostics."""

from typing import Any

from msss_graphslam.nodes.others_refusals import OthersRefusals
from msss_graphslam.recordings.typestore import make


def said(name: str, **values: object) -> Any:
    rows = [
        make("diagnostic_msgs/msg/KeyValue", key=key.replace("__", "/"), value=str(value))
        for key, value in values.items()
    ]
    status = make("diagnostic_msgs/msg/DiagnosticStatus", name=name, values=rows)
    return make("diagnostic_msgs/msg/DiagnosticArray", status=[status])


def test_the_newest_counts_of_the_namespace_are_summed() -> None:
    others = OthersRefusals("/sub/back_end")
    others.hear(said("/sub/front_end", refused__late=3))
    others.hear(said("/sub/front_end", refused__late=5, rate__scan=2))
    others.hear(said("/sub/dead_reckoning", refused__late=1, lost__imu=2, lost__scan=0))
    others.hear(said("/sub/back_end", refused__late=100))
    others.hear(said("/other/front_end", refused__late=100))
    others.hear(said("/front_end", refused__late=100))
    assert others.total == {"late": 6, "lost/imu": 2}
    others.clear()
    assert not others.total


def test_what_is_no_number_is_left_out() -> None:
    others = OthersRefusals("/back_end")
    others.hear(said("/front_end", refused__late="none", refused__early=1))
    assert others.total == {"early": 1}
