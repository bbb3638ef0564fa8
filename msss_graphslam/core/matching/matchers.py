# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The two ways to match scans, behind one interface."""

from typing import Any, Protocol

from msss_graphslam.config.groups import Matching
from msss_graphslam.core.matching import spic
from msss_graphslam.core.matching.line_features import line_features
from msss_graphslam.core.matching.match_result import MatchResult
from msss_graphslam.core.matching.point_slips import point_slips
from msss_graphslam.core.matching.point_to_line import match_lines
from msss_graphslam.core.types import Array, Scan

__all__ = ["LineMatcher", "ScanMatcher", "SpicMatcher"]


class ScanMatcher(Protocol):
    """Prepares a scan once, then matches it with others."""

    def prepare(self, scan: Scan) -> Any:
        """Return what ``match`` needs of a scan."""

    def match(
        self,
        reference: Any,
        current: Any,
        initial: Array,
        initial_covariance: Array,
        start: Array | None = None,
    ) -> MatchResult:
        """Return the displacement of the current scan in the reference scan.

        ``start`` (3,) is what an earlier match of the two has found.
        """


class SpicMatcher:
    """spIC, the paper's."""

    def __init__(self, config: Matching) -> None:
        self._config = config

    def prepare(self, scan: Scan) -> Scan:
        """Return the scan: spIC takes points and covariances as they are."""
        return scan

    def match(
        self,
        reference: Scan,
        current: Scan,
        initial: Array,
        initial_covariance: Array,
        start: Array | None = None,  # noqa: ARG002
    ) -> MatchResult:
        """Match by ``spic.match``; the paper starts from ``initial``."""
        return spic.match(
            reference.points,
            reference.covariances,
            current.points,
            current.covariances,
            initial,
            initial_covariance,
            self._config,
        )


class LineMatcher:
    """Point-to-line, forwards and backwards."""

    def __init__(self, config: Matching) -> None:
        self._config = config

    def prepare(self, scan: Scan) -> Any:
        """Return the scan's local lines."""
        return line_features(scan.points, scan.covariances, point_slips(scan))

    def match(
        self,
        reference: Any,
        current: Any,
        initial: Array,
        initial_covariance: Array,
        start: Array | None = None,
    ) -> MatchResult:
        """Match by ``match_lines``."""
        return match_lines(reference, current, initial, initial_covariance, self._config, start)
