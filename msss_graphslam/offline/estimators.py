# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The estimator that somebody has named."""

from msss_graphslam.core.recipes import ESTIMATORS, Recipe
from msss_graphslam.errors import UserError

__all__ = ["recipe_named"]


def recipe_named(name: str) -> Recipe:
    """Return the estimator; UserError for an unknown name."""
    if name not in ESTIMATORS:
        raise UserError(f"unknown estimator {name!r}; choose one of {', '.join(ESTIMATORS)}")
    return ESTIMATORS[name]
