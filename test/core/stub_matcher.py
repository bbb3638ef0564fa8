# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Matchers whose answers a test makes up, whatever the scans are."""

from typing import Any

from msss_graphslam.core.matching.match_result import MatchResult
from msss_graphslam.core.types import Array


class StubMatcher:
    """A matcher that takes scans as they are, and answers by the guess alone."""

    def prepare(self, scan: Any) -> Any:
        return scan

    def match(
        self,
        reference: Any,  # noqa: ARG002
        current: Any,  # noqa: ARG002
        initial: Array,
        initial_covariance: Array,
        start: Array | None = None,
    ) -> MatchResult:
        return self.answer(initial, initial_covariance, start)

    def answer(self, initial: Array, covariance: Array, start: Array | None) -> MatchResult:
        raise NotImplementedError
