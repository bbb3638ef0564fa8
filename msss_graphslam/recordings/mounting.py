# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Where the head sits on the vehicle: from a YAML file, or from a bag's static transforms."""

from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any, Self

import numpy as np
import yaml

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.errors import UserError
from msss_graphslam.messages import Refusal, decoding, encoding
from msss_graphslam.messages.frames import BASE_LINK, SONAR_LINK
from msss_graphslam.recordings.typestore import make

__all__ = ["Mounting"]

_POSE = ("mount_x", "mount_y", "mount_yaw")


@dataclass(frozen=True, slots=True)
class Mounting:
    """The pose of sonar_link in base_link, by the names of the configuration [m, rad].

    ``inverted`` says that the head stands upside down and that its recording takes no account
    of it; a conversion mirrors the bearings then, so a bag never has to tell.
    """

    mount_x: float = 0.0
    mount_y: float = 0.0
    mount_yaw: float = 0.0
    inverted: bool = False

    @classmethod
    def from_yaml(cls, path: Path | str) -> Self:
        """Read ``sonar: {mount_x: ..., mount_y: ..., mount_yaw: ..., inverted: ...}``.

        What is left out is 0 or false. Raises UserError where the file is not such.
        """
        values = _sonar_group(Path(path))
        known = [field.name for field in fields(cls)]
        if not set(values) <= set(known):
            unknown = ", ".join(sorted(set(values) - set(known)))
            raise UserError(f"{path}: unknown under sonar: {unknown}; known: {', '.join(known)}")
        inverted = values.pop("inverted", False)
        if not isinstance(inverted, bool):
            raise UserError(f"{path}: sonar.inverted must be true or false, not {inverted!r}")
        sonar = Configuration().with_values({f"sonar.{key}": values[key] for key in values}).sonar
        return cls(sonar.mount_x, sonar.mount_y, sonar.mount_yaw, inverted)

    @classmethod
    def from_transforms(cls, message: Any) -> Self | None:
        """Return the mounting that a tf2_msgs/TFMessage holds, or None."""
        for transform in message.transforms:
            ends = transform.header.frame_id.lstrip("/"), transform.child_frame_id.lstrip("/")
            if ends == (BASE_LINK, SONAR_LINK):
                try:
                    x, y, _, _, _, yaw = decoding.placement(transform).tolist()
                except Refusal:
                    return None
                return cls(x, y, yaw)
        return None

    @property
    def parameters(self) -> dict[str, float]:
        """The parameters of the configuration that say the same."""
        return {f"sonar.{name}": getattr(self, name) for name in _POSE}

    def completes(self, configuration: Configuration) -> Configuration:
        """Return the configuration with this mounting; a value that is not the default stays."""
        default, chosen = Configuration().sonar, configuration.sonar
        missing = {
            f"sonar.{name}": getattr(self, name)
            for name in _POSE
            if getattr(chosen, name) == getattr(default, name)
        }
        return configuration.with_values(missing)

    def transforms(self, stamp_ns: int) -> Any:
        """Return the tf2_msgs/TFMessage for the bag's static transforms."""
        pose = np.array([self.mount_x, self.mount_y, 0.0, 0.0, 0.0, self.mount_yaw])
        transform = encoding.transform(make, stamp_ns, pose, BASE_LINK, SONAR_LINK)
        return encoding.tf_message(make, [transform])


def _sonar_group(path: Path) -> dict[str, Any]:
    try:
        content = yaml.safe_load(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, yaml.YAMLError) as error:
        raise UserError(f"{path}: cannot be read as YAML ({error})".replace("\n", " ")) from error
    group = content.get("sonar") if isinstance(content, dict) else None
    if not isinstance(group, dict) or len(content) != 1:
        raise UserError(f"{path}: must hold one group, sonar, with {', '.join(_POSE)}")
    return {str(key): value for key, value in group.items()}
