# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""A foreign recording; if it is a bag, of ROS 1 or ROS 2, what it holds."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from functools import cached_property
from pathlib import Path

from rosbags import rosbag1, rosbag2
from rosbags.interfaces import Connection

from msss_graphslam.errors import UserError

__all__ = ["ForeignSource"]

_ROS1 = b"#ROSBAG V2.0"
_ROS2 = {".mcap": b"\x89MCAP0\r\n", ".db3": b"SQLite format 3"}


class ForeignSource:
    """A file or folder to convert; what several formats look for in a bag is read once."""

    def __init__(self, path: Path) -> None:
        self.path = path

    @property
    def is_ros1(self) -> bool:
        """Whether the file, if it is a bag, is one of ROS 1."""
        return self.path.is_file() and self.path.suffix not in _ROS2

    @cached_property
    def connections(self) -> list[Connection]:
        """The topics of a bag; none where the file or folder is not one at all."""
        if not self._is_bag():
            return []
        with self._opened() as bag:
            return list(bag.connections)

    def messages(self, chosen: Sequence[Connection]) -> Iterator[tuple[Connection, int, bytes]]:
        """Yield the messages of these topics of a bag, and when they were received [ns].

        Raises UserError where the bag is damaged.
        """
        with self._opened() as bag:
            messages = bag.messages(chosen)
            while True:
                try:
                    message = next(messages)
                except StopIteration:
                    return
                except Exception as error:  # a library meets arbitrary bytes
                    raise self._damage(error) from error
                yield message

    def _is_bag(self) -> bool:
        if self.path.is_dir():
            return (self.path / "metadata.yaml").is_file()
        with self.path.open("rb") as stream:
            head = stream.read(len(_ROS1) + 4)
        return head.startswith(_ROS2.get(self.path.suffix, _ROS1))

    @contextmanager
    def _opened(self) -> Iterator[rosbag1.Reader | rosbag2.Reader]:
        try:
            bag = rosbag1.Reader(self.path) if self.is_ros1 else rosbag2.Reader(self.path)
            bag.open()
        except Exception as error:  # a library meets arbitrary bytes
            raise self._damage(error) from error
        try:
            yield bag
        finally:
            bag.close()

    def _damage(self, error: Exception) -> UserError:
        what = " ".join(str(error).split()) or type(error).__name__
        if self.is_ros1:
            advice = "repair it by `rosbag reindex` or `rosbag fix`"
        elif self.path.suffix == ".db3":
            advice = "nothing here repairs an sqlite3 file"
        else:
            advice = "save what can be read of an mcap by `msss salvage`"
        return UserError(f"{self.path}: the bag is damaged ({what}); {advice}")
