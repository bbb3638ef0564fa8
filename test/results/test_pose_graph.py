# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
import gtsam
import numpy as np
from synthetic_run import synthetic_run

from msss_graphslam.results.pose_graph import write_pose_graph


def test_gtsam_reads_the_graph_that_was_written(tmp_path):
    estimate = synthetic_run(6).estimate
    path = tmp_path / "graph.g2o"
    write_pose_graph(path, estimate.keyframes, estimate.constraints)
    factors, values = gtsam.readG2o(str(path), False)
    accepted = [edge for edge in estimate.constraints if edge.accepted]
    assert values.size() == len(estimate.keyframes)
    assert factors.size() == len(accepted) < len(estimate.constraints)
    for number, frame in enumerate(estimate.keyframes):
        read = values.atPose2(number)
        np.testing.assert_allclose([read.x(), read.y()], frame.pose[:2], rtol=0, atol=1e-12)
        assert abs(np.sin((read.theta() - frame.pose[2]) / 2.0)) < 1e-12
    for number, edge in enumerate(accepted):
        factor = factors.at(number)
        assert factor.keys() == [edge.first, edge.second]
        np.testing.assert_allclose(
            factor.noiseModel().covariance(), edge.covariance, rtol=1e-9, atol=1e-15
        )
        read = factor.measured()
        np.testing.assert_allclose([read.x(), read.y()], edge.relative_pose[:2], atol=1e-12)


def test_an_empty_graph_is_an_empty_file(tmp_path):
    write_pose_graph(tmp_path / "graph.g2o", (), ())
    assert (tmp_path / "graph.g2o").read_bytes() == b""
