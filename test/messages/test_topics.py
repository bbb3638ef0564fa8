# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Topics are found by name, under any namespace."""

import pytest

from msss_graphslam.messages import topics


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("/sonar/ping", topics.SONAR_PING),
        ("/auv/one/sonar/ping", topics.SONAR_PING),
        ("/mysonar/ping", None),
        ("/pressure", topics.PRESSURE),
        ("/tank_pressure", None),
        ("/camera", None),
    ],
)
def test_find(name: str, expected: topics.Topic | None) -> None:
    assert topics.find(name) == expected


def test_the_longer_name_is_meant() -> None:
    found = topics.find("/auv/map/points")
    assert found is not None and found.name == "map/points"
    keyframes = topics.find("/graph/keyframes")
    assert keyframes is not None and keyframes.latched
