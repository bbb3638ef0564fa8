# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Whether the last scan has come, whatever comes first."""

from msss_graphslam.nodes.last_scan import LastScan


def test_nothing_is_known_before_it_is_told() -> None:
    last = LastScan()
    last.came(5)
    assert not last.take()


def test_the_scan_may_come_before_or_after_it_is_told() -> None:
    for first, second in (("came", "told"), ("told", "came")):
        last = LastScan()
        getattr(last, first)(5)
        getattr(last, second)(5)
        assert last.take()


def test_one_that_is_on_its_way_is_waited_for() -> None:
    last = LastScan()
    last.came(4)
    last.told(5)
    assert not last.take()
    last.came(5)
    assert last.take()


def test_a_mission_without_a_scan_has_none_to_wait_for() -> None:
    last = LastScan()
    last.told(0)
    assert last.take()


def test_it_holds_once() -> None:
    last = LastScan()
    last.came(5)
    last.told(5)
    assert last.take()
    assert not last.take()


def test_a_newer_scan_makes_it_outdated() -> None:
    last = LastScan()
    last.told(5)
    last.came(5)
    last.came(6)
    assert not last.take()
    last.told(6)
    assert last.take()
