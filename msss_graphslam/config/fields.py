# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What a parameter is: value, unit, range, meaning, source; said once, used by every interface."""

from collections.abc import Sequence
from dataclasses import Field, dataclass, field, fields
from typing import Any

from msss_graphslam.errors import UserError

__all__ = ["ParameterError", "ParameterInfo", "check", "describe", "parameter"]


class ParameterError(UserError, ValueError):
    """A parameter is unknown, of the wrong type or out of its range."""


@dataclass(frozen=True, slots=True)
class ParameterInfo:
    """All that an interface has to know of one parameter."""

    name: str
    kind: type
    default: Any
    meaning: str
    unit: str
    minimum: float | None
    maximum: float | None
    choices: tuple[Any, ...]
    source: str

    def validate(self, value: Any) -> Any:
        """Return the value in the parameter's type, or raise ParameterError."""
        value = self._in_kind(value)
        if self.choices and value not in self.choices:
            raise ParameterError(f"{self.name} = {value!r}: must be one of {self.range_text}")
        below = self.minimum is not None and not value >= self.minimum
        above = self.maximum is not None and not value <= self.maximum
        if below or above or value != value:
            raise ParameterError(f"{self.name} = {value!r}: must lie in {self.range_text}")
        return value

    @property
    def range_text(self) -> str:
        """The admitted values in words."""
        if self.choices:
            return ", ".join(map(str, self.choices))
        if self.minimum is None and self.maximum is None:
            return ""
        low = "-inf" if self.minimum is None else f"{self.minimum:g}"
        high = "inf" if self.maximum is None else f"{self.maximum:g}"
        return f"[{low}, {high}]"

    def _in_kind(self, value: Any) -> Any:
        if self.kind is float and isinstance(value, int) and not isinstance(value, bool):
            return float(value)
        if isinstance(value, str) and self.kind is not str:
            return self._parse(value)
        if type(value) is not self.kind:
            raise ParameterError(f"{self.name} = {value!r}: must be of type {self.kind.__name__}")
        return value

    def _parse(self, text: str) -> Any:
        if self.kind is bool:
            if text.lower() in ("true", "false"):
                return text.lower() == "true"
        else:
            try:
                return self.kind(text)
            except ValueError:
                pass
        raise ParameterError(f"{self.name} = {text!r}: must be of type {self.kind.__name__}")


def parameter(
    default: Any,
    meaning: str,
    *,
    unit: str = "",
    minimum: float | None = None,
    maximum: float | None = None,
    choices: Sequence[Any] = (),
    source: str = "",
) -> Any:
    """Declare one field of a configuration group."""
    return field(
        default=default,
        metadata={
            "meaning": meaning,
            "unit": unit,
            "minimum": minimum,
            "maximum": maximum,
            "choices": tuple(choices),
            "source": source,
        },
    )


def describe(group: type | Any, prefix: str = "") -> list[ParameterInfo]:
    """List the parameters of a group, named ``prefix.field``."""
    return [_info(entry, prefix) for entry in fields(group)]


def check(group: Any, prefix: str = "") -> None:
    """Raise ParameterError if any value of the group is not admitted."""
    for entry, info in zip(fields(group), describe(group, prefix), strict=True):
        info.validate(getattr(group, entry.name))


def _info(entry: Field[Any], prefix: str) -> ParameterInfo:
    name = f"{prefix}.{entry.name}" if prefix else entry.name
    return ParameterInfo(
        name=name, kind=type(entry.default), default=entry.default, **entry.metadata
    )
