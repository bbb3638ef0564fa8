# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What the tests of the whole share: missions, made once a session, and a domain each."""

import fcntl
import os
from collections.abc import Callable, Iterator
from functools import cache

import pytest
from nodes.conftest import tf2_environment
from nodes.processes import Domain, domain
from system.missions import Mission, make_mission

__all__ = ["tf2_environment"]


@pytest.fixture(scope="session")
def mission(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Mission]:
    """Give the short mission of a world by its name; it is made once for all workers."""
    base = tmp_path_factory.getbasetemp()
    # With workers each has a folder of its own, in one that they share.
    shared = base.parent if "PYTEST_XDIST_WORKER" in os.environ else base

    @cache
    def made(name: str) -> Mission:
        with (shared / f"mission_{name}.lock").open("w") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            return make_mission(name, shared / f"mission_{name}")

    return made


@pytest.fixture(scope="session")
def pond(mission: Callable[[str], Mission]) -> Mission:
    """The mission in the pond."""
    return mission("pond")


@pytest.fixture
def own_domain() -> Iterator[Domain]:
    """A ROS domain for this test alone."""
    with domain() as own:
        yield own
