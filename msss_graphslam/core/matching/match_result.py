# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What a scan matcher answers."""

from dataclasses import dataclass, field

from msss_graphslam.core.types import Array

__all__ = ["MatchResult"]


@dataclass(frozen=True, slots=True)
class MatchResult:
    """The displacement between two scans, accepted or refused.

    ``relative_pose`` (3,) [m, m, rad] is the current scan's frame in the reference scan's,
    ``covariance`` (3, 3) its covariance. ``refusal`` is empty where the match was accepted;
    ``figures`` holds the values of the tests by name. Algorithm 4, lines 5 and 11.
    """

    relative_pose: Array
    covariance: Array
    refusal: str = ""
    figures: dict[str, float] = field(default_factory=dict)

    @property
    def accepted(self) -> bool:
        """Whether the match may become a constraint."""
        return not self.refusal
