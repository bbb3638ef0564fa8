# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The tool as a real process."""

import os
import subprocess
import sys
from pathlib import Path

__all__ = ["Done", "assert_one_line", "msss"]

Done = subprocess.CompletedProcess[str]


def msss(*arguments: object, cwd: Path | None = None) -> Done:
    """Run the tool, its output in pipes."""
    return subprocess.run(
        [sys.executable, "-m", "msss_graphslam", *map(str, arguments)],
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
        cwd=cwd,
        env={**os.environ, "COLUMNS": "80", "PYTHONPATH": os.pathsep.join(_search_path())},
    )


def _search_path() -> list[str]:
    """Return where this process finds modules, the package also where it is not installed."""
    return [str(Path(__file__).parents[1]), *filter(None, [os.environ.get("PYTHONPATH")])]


def assert_one_line(done: Done) -> None:
    """Assert that the tool gave up with one line on standard error and nothing else."""
    assert done.returncode == 1
    assert done.stdout == ""
    assert done.stderr.startswith("msss: ")
    assert done.stderr.count("\n") == 1
    assert "Traceback" not in done.stderr
