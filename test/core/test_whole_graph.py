# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
from short_slam import CONFIGURATION, slam_of

from msss_graphslam.core.graph.whole_graph import whole_graph
from msss_graphslam.core.recipes import ESTIMATORS


def test_the_whole_graph_at_once_is_the_graph_step_by_step() -> None:
    """Where it has settled; loops' robust kernels make several minima."""
    slam = slam_of(ESTIMATORS["uspic"], 8)
    back_end = whole_graph(slam.front_end.poses, slam.constraints, CONFIGURATION.back_end)
    np.testing.assert_allclose(back_end.poses(), slam.front_end.poses, atol=1e-9)
    for number, node in enumerate(slam.front_end.nodes):
        np.testing.assert_allclose(
            back_end.covariance(number), node.covariance, rtol=1e-3, atol=1e-8
        )


def test_the_whole_graph_of_nothing_is_empty() -> None:
    back_end = whole_graph(np.empty((0, 3)), [], CONFIGURATION.back_end)
    assert back_end.poses().shape == (0, 3)
