# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What an estimator is called, and its colour, in every figure and table."""

__all__ = ["ACCENT", "colour", "label", "phrase"]

ACCENT = "#0072b2"
_ESTIMATORS = {
    "dead_reckoning": "#d55e00",
    "uspic": "#cc79a7",
    "chen2015": "#009e73",
    "full": "#0072b2",
}


def colour(estimator: str) -> str:
    """Return the estimator's colour, safe for the colour-blind (Okabe and Ito)."""
    return _ESTIMATORS.get(estimator, ACCENT)


def phrase(name: str) -> str:
    """Return a snake_case name in words."""
    return name.replace("_", " ")


def label(estimator: str) -> str:
    """Return the estimator's name as a legend says it."""
    return phrase(estimator)
