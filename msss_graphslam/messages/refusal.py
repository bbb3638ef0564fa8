# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The refusal of one message, with its reason."""

import re

__all__ = ["Refusal", "in_one_word"]


class Refusal(Exception):  # noqa: N818 - not an error of the program
    """A message cannot be used; whoever reads counts it under ``reason`` (snake_case)."""

    def __init__(self, reason: str) -> None:
        super().__init__(reason)
        self.reason = reason


def in_one_word(reason: str) -> str:
    """Return a reason given in words as those of a Refusal are: in snake_case."""
    return re.sub(r"\W+", "_", reason).strip("_").lower()
