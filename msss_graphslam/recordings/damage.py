# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What could not be read of a recording."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Self

__all__ = ["Damage"]


@dataclass(slots=True)
class Damage:
    """The losses of one file or of a whole bag.

    ``broken_chunks`` failed their checksum or did not unpack, ``skipped_bytes`` belong to no whole
    record, ``truncated`` says that the file has no end. ``lost_messages`` is counted against what
    the file or its metadata.yaml promises, None where nothing tells.
    """

    broken_chunks: int = 0
    skipped_bytes: int = 0
    truncated: bool = False
    lost_messages: int | None = 0

    def __bool__(self) -> bool:
        """Whether anything at all is damaged."""
        return bool(
            self.broken_chunks or self.skipped_bytes or self.truncated or self.lost_messages
        )

    def __str__(self) -> str:
        """Describe the damage in one line."""
        if not self:
            return "no damage"
        lost = "an unknown number of" if self.lost_messages is None else str(self.lost_messages)
        parts = [f"{lost} messages lost"]
        if self.truncated:
            parts.append("the file ends early")
        if self.broken_chunks:
            parts.append(f"{self.broken_chunks} broken chunks")
        if self.skipped_bytes:
            parts.append(f"{self.skipped_bytes} unreadable bytes")
        return ", ".join(parts)

    @classmethod
    def total(cls, damages: Iterable[Self]) -> Self:
        """Sum up the damage of several files."""
        whole = cls()
        for damage in damages:
            whole.broken_chunks += damage.broken_chunks
            whole.skipped_bytes += damage.skipped_bytes
            whole.truncated |= damage.truncated
            if whole.lost_messages is None or damage.lost_messages is None:
                whole.lost_messages = None
            else:
                whole.lost_messages += damage.lost_messages
        return whole
