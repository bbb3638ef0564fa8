# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What the tests of the nodes share."""

import fcntl
import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest
from nodes import build_tf2_msgs


@pytest.fixture
def at() -> Iterator[Any]:
    """Give a ROS domain of the test's own."""
    from nodes.processes import domain

    with domain() as found:
        yield found


@pytest.fixture(scope="session")
def tf2_environment(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """What to add to the environment of a process that publishes or receives ``/tf``.

    Nothing where ROS brings ``tf2_msgs``; elsewhere it is built, once for all workers.
    """
    if find_spec("tf2_msgs") is not None:
        return {}
    missing = [name for name in build_tf2_msgs.COMPILERS if shutil.which(name) is None]
    if missing:
        pytest.skip(
            f"tf2_msgs is not installed and cannot be built: no {' and no '.join(missing)}"
        )
    base = tmp_path_factory.getbasetemp()
    # With workers each has a folder of its own, in one that they share.
    prefix = (base.parent if "PYTEST_XDIST_WORKER" in os.environ else base) / "tf2_msgs"
    build_once(prefix)
    return build_tf2_msgs.environment(prefix)


def build_once(prefix: Path) -> None:
    """Build unless another worker did; wait where one is at it."""
    with prefix.with_suffix(".lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if prefix.exists():
            return
        unfinished = prefix.with_suffix(".unfinished")
        shutil.rmtree(unfinished, ignore_errors=True)
        script = [sys.executable, build_tf2_msgs.__file__, unfinished]
        done = subprocess.run(script, capture_output=True, text=True, timeout=120, check=False)
        assert done.returncode == 0, done.stderr
        unfinished.rename(prefix)
