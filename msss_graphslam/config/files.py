# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Parameter files: read as people write them, written as ROS reads them."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import yaml

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.errors import UserError

__all__ = ["read_parameters", "ros_parameters"]

_ROS_KEY = "ros__parameters"


def read_parameters(path: Path) -> dict[str, Any]:
    """Read a YAML file as ``{"group.name": value}``.

    The groups stand either at the top, as in a run's summary, or in ROS's form, below
    ``/**: ros__parameters:``. Raises UserError for a file that cannot be read so; names and values
    are left to Configuration.with_values.
    """
    try:
        content = yaml.safe_load(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise UserError(f"{path}: cannot be read ({error.strerror})") from error
    except (UnicodeDecodeError, yaml.YAMLError) as error:
        where = " ".join(str(error).split())
        raise UserError(f"{path}: not a YAML file ({where})") from error
    if content is None:
        return {}
    if not isinstance(content, dict):
        raise UserError(f"{path}: must hold `group: {{name: value}}`, not {_kind(content)}")
    return dict(_flatten(_without_nodes(content)))


def ros_parameters(configuration: Configuration) -> str:
    """Return the parameters as a ROS parameter file for every node, each with its meaning."""
    lines = ["/**:", f"  {_ROS_KEY}:"]
    values = configuration.as_dict()
    group = ""
    for info in configuration.parameters():
        head, _, name = info.name.partition(".")
        if head != group:
            group = head
            lines.append(f"    {group}:")
        remark = "; ".join(filter(None, [info.meaning, info.unit, info.range_text]))
        lines += [f"      # {remark}", f"      {name}: {_scalar(values[group][name])}"]
    return "\n".join(lines) + "\n"


def _kind(content: Any) -> str:
    return "a list" if isinstance(content, list) else "a single value"


def _without_nodes(content: dict[Any, Any]) -> dict[Any, Any]:
    """Return the groups, with the node names and the ROS key above them taken off."""
    sections = [
        section[_ROS_KEY]
        for section in content.values()
        if isinstance(section, dict) and isinstance(section.get(_ROS_KEY), dict)
    ]
    if not sections:
        return content
    return {key: value for section in sections for key, value in section.items()}


def _flatten(groups: dict[Any, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    for key, value in groups.items():
        name = f"{prefix}{key}"
        if isinstance(value, dict):
            yield from _flatten(value, f"{name}.")
        else:
            yield name, value


def _scalar(value: Any) -> str:
    """Return the value in YAML, a float always with its point (ROS tells 20 from 20.0)."""
    return str(yaml.safe_dump(value)).splitlines()[0]
