# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The direction of imports, and that a breach of it would be found."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
LINTER = Path(sys.executable).with_name("lint-imports")

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not LINTER.exists(), reason="import-linter is not installed here"),
]


def lint(folder: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [LINTER, "--no-cache"],
        cwd=folder,
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )


def test_imports_keep_their_rules() -> None:
    done = lint(ROOT)
    assert done.returncode == 0, done.stdout


@pytest.mark.parametrize(
    ("module", "statement", "contract"),
    [
        ("core/compounding.py", "import msss_graphslam.results.tum", "Imports run downwards"),
        ("core/compounding.py", "import time", "The core is mathematics"),
        ("messages/topics.py", "import rclpy", "No module but the nodes"),
        ("offline/__init__.py", "import rosbags", "Bags are opened under recordings alone"),
        ("simulation/path.py", "import msss_graphslam.core.compounding", "The simulator shares"),
        ("evaluation/errors.py", "import msss_graphslam.core.pipeline", "The evaluation uses no"),
    ],
)
def test_a_breach_is_found(tmp_path: Path, module: str, statement: str, contract: str) -> None:
    shutil.copytree(
        ROOT / "msss_graphslam",
        tmp_path / "msss_graphslam",
        ignore=shutil.ignore_patterns("__pycache__"),
    )
    shutil.copy(ROOT / "pyproject.toml", tmp_path)
    path = tmp_path / "msss_graphslam" / module
    path.write_text(path.read_text(encoding="utf-8") + statement + "\n", encoding="utf-8")
    done = lint(tmp_path)
    assert done.returncode == 1
    broken = [line for line in done.stdout.splitlines() if " BROKEN" in line]
    assert any(line.startswith(contract) for line in broken)
