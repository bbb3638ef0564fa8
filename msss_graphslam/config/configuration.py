# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The whole configuration: groups by name, changed by ``group.name=value``."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, fields, replace
from typing import Any, Self

from msss_graphslam.config import groups
from msss_graphslam.config.fields import ParameterError, ParameterInfo, describe

__all__ = ["Configuration"]


@dataclass(frozen=True, slots=True)
class Configuration:
    """The resolved parameters of a run."""

    sonar: groups.Sonar = field(default_factory=groups.Sonar)
    sensors: groups.Sensors = field(default_factory=groups.Sensors)
    segmentation: groups.Segmentation = field(default_factory=groups.Segmentation)
    dead_reckoning: groups.DeadReckoning = field(default_factory=groups.DeadReckoning)
    scanning: groups.Scanning = field(default_factory=groups.Scanning)
    association: groups.Association = field(default_factory=groups.Association)
    matching: groups.Matching = field(default_factory=groups.Matching)
    back_end: groups.BackEnd = field(default_factory=groups.BackEnd)
    mapping: groups.Mapping = field(default_factory=groups.Mapping)
    micron: groups.Micron = field(default_factory=groups.Micron)

    @classmethod
    def parameters(cls) -> list[ParameterInfo]:
        """Every parameter, as ``group.name``, in the order of declaration."""
        instance = cls()
        return [
            info
            for group in fields(cls)
            for info in describe(getattr(instance, group.name), group.name)
        ]

    def with_values(self, values: Mapping[str, Any]) -> Self:
        """Return a copy with ``{"group.name": value}`` applied; text is parsed.

        Raises ParameterError for an unknown name, a wrong type or a value out of range.
        """
        known = {info.name: info for info in self.parameters()}
        changes: dict[str, dict[str, Any]] = {}
        for name, value in values.items():
            if name not in known:
                raise ParameterError(f"unknown parameter {name!r}{_suggestion(name, known)}")
            group, _, key = name.partition(".")
            changes.setdefault(group, {})[key] = known[name].validate(value)
        return replace(
            self,
            **{group: replace(getattr(self, group), **keys) for group, keys in changes.items()},
        )

    def as_dict(self) -> dict[str, dict[str, Any]]:
        """Return the values as nested dictionaries, ready for YAML or JSON."""
        return asdict(self)


def _suggestion(name: str, known: Mapping[str, ParameterInfo]) -> str:
    from difflib import get_close_matches

    near = get_close_matches(name, known, n=1)
    return f"; did you mean {near[0]!r}?" if near else ""
