# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Dead reckoning and scans, made once for many runs over the same measurements."""

from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from typing import Any
from unittest.mock import patch

from msss_graphslam.core import pipeline

__all__ = ["FrontMemory"]

_REMEMBERED = ("DeadReckoning", "ScanGenerator")


class FrontMemory:
    """The answers that these parts of a pipeline gave in their first run.

    In every later run they are given again, in the same order, whatever is asked.
    """

    def __init__(self) -> None:
        self._answers: dict[str, list[Any]] = {}

    @contextmanager
    def in_use(self) -> Iterator[None]:
        """Let pipelines that are made meanwhile remember, or recall."""
        with ExitStack() as stack:
            for name in _REMEMBERED:
                maker = self._maker(name, getattr(pipeline, name))
                stack.enter_context(patch.object(pipeline, name, maker))
            yield

    def _maker(self, name: str, original: Callable[..., Any]) -> Callable[..., Any]:
        def make(*arguments: Any) -> Any:
            if name in self._answers:
                return _Recalling(self._answers[name])
            self._answers[name] = []
            return _Remembering(original(*arguments), self._answers[name])

        return make


class _Remembering:
    """Notes what every call of the ``original`` returns."""

    def __init__(self, original: Any, answers: list[Any]) -> None:
        self._original = original
        self._answers = answers

    def __getattr__(self, name: str) -> Callable[..., Any]:
        called = getattr(self._original, name)

        def call(*arguments: Any) -> Any:
            answer = called(*arguments)
            self._answers.append(answer)
            return answer

        setattr(self, name, call)
        return call


class _Recalling:
    """Returns the next answer to every call."""

    def __init__(self, answers: list[Any]) -> None:
        self._next = iter(answers).__next__

    def __getattr__(self, name: str) -> Callable[..., Any]:
        del name

        def call(*arguments: Any) -> Any:
            del arguments
            return self._next()

        return call
