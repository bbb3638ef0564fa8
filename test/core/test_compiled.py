# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
import inspect
import re
import runpy
from pathlib import Path
from typing import Any

import pytest
from numba import njit

from msss_graphslam.core.compiled import compiled

CORE = Path(__file__).parents[2] / "msss_graphslam" / "core"


def made_of_text() -> Any:
    """Return a function that stands in no file, beside which it could be kept."""
    names: dict[str, Any] = {}
    exec("def twice(number):\n    return 2.0 * number", names)  # noqa: S102
    return names["twice"]


def test_what_cannot_be_kept_is_compiled_all_the_same() -> None:
    with pytest.raises(RuntimeError, match="cannot cache"):
        njit(cache=True)(made_of_text())
    assert compiled(made_of_text())(21.0) == 42.0


def test_loops_know_of_no_others_and_of_no_constants() -> None:
    """What numba has kept it takes for good as long as the loop's own file does not change."""
    compiling = re.compile("^@compiled", re.MULTILINE)
    files = [path for path in CORE.rglob("*.py") if compiling.search(path.read_text("utf-8"))]
    assert files
    for path in files:
        loops = runpy.run_path(str(path))
        used = {
            name: loops[name]
            for function in loops.values()
            if hasattr(function, "py_func")
            for name in function.py_func.__code__.co_names
            if name in loops
        }
        foreign = {
            name
            for name, value in used.items()
            if not inspect.ismodule(value) and getattr(value, "__module__", "") != "<run_path>"
        }
        assert not foreign, f"{path.name}: {foreign}"
