# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
from typing import Any

import pytest
from numba import njit

from msss_graphslam.core.compiled import compiled


def made_of_text() -> Any:
    """Return a function that stands in no file, beside which it could be kept."""
    names: dict[str, Any] = {}
    exec("def twice(number):\n    return 2.0 * number", names)  # noqa: S102
    return names["twice"]


def test_what_cannot_be_kept_is_compiled_all_the_same() -> None:
    with pytest.raises(RuntimeError, match="cannot cache"):
        njit(cache=True)(made_of_text())
    assert compiled(made_of_text())(21.0) == 42.0
