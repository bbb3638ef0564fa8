# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Which files make a recording."""

import re
from pathlib import Path
from typing import Any

import yaml

from msss_graphslam.errors import UserError

__all__ = ["mcap_files", "require_absent"]


def mcap_files(path: Path) -> dict[Path, int | None]:
    """Return the mcap files of a recording, with the number of messages promised for each.

    ``path`` is an mcap file or a rosbag2 folder; a folder without a readable metadata.yaml gives
    all its mcap files. Raises UserError where there is none.
    """
    if not path.exists():
        raise UserError(f"{path}: no such file or folder")
    if path.is_file():
        _check_format(path)
        return {path: None}
    files = _described(path) or dict.fromkeys(sorted(path.glob("*.mcap"), key=_by_number))
    if not files:
        raise UserError(f"{path}: no recording in this folder; {_advice(path)}")
    return files


def require_absent(path: Path) -> None:
    """Raise UserError where a new recording would overwrite something."""
    if path.exists():
        raise UserError(f"{path} exists already: remove it or choose another name")


def _check_format(path: Path) -> None:
    with path.open("rb") as stream:
        head = stream.read(16)
    if not head:
        raise UserError(f"{path}: the file is empty")
    if head.startswith(b"#ROSBAG V"):
        raise UserError(f"{path}: a ROS 1 bag; make it readable by `msss convert`")
    if head.startswith(b"SQLite format 3"):
        raise UserError(f"{path}: an sqlite3 bag; make an mcap of it by `ros2 bag convert`")


def _advice(folder: Path) -> str:
    if any(folder.glob("*.db3")):
        return "it holds an sqlite3 bag: make an mcap of it by `ros2 bag convert`"
    if any(folder.glob("*.mcap.zstd")):
        return "unpack its compressed files by `unzstd *.mcap.zstd`"
    return "give an mcap file or a rosbag2 folder that holds one"


def _described(folder: Path) -> dict[Path, int | None]:
    """Return the existing files that metadata.yaml names; one that is missing is a UserError."""
    information = _information(folder / "metadata.yaml")
    counts = {
        str(entry.get("path")): entry.get("message_count")
        for entry in _mappings(information.get("files"))
    }
    names = information.get("relative_file_paths")
    files = [folder / str(name) for name in names] if isinstance(names, list) else []
    if not all(file.suffix == ".mcap" for file in files):
        return {}
    missing = [file.name for file in files if not file.is_file()]
    if missing:
        raise UserError(
            f"{folder}: metadata.yaml names {missing[0]}, which is not there; bring it back, or"
            " remove metadata.yaml to read what is there"
        )
    return {file: _count(counts.get(file.name)) for file in files}


def _information(path: Path) -> dict[str, Any]:
    try:
        content = yaml.safe_load(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, yaml.YAMLError):
        return {}
    information = content.get("rosbag2_bagfile_information") if isinstance(content, dict) else None
    return information if isinstance(information, dict) else {}


def _mappings(value: Any) -> list[dict[str, Any]]:
    return [entry for entry in value if isinstance(entry, dict)] if isinstance(value, list) else []


def _count(value: Any) -> int | None:
    return value if isinstance(value, int) and value >= 0 else None


def _by_number(path: Path) -> list[tuple[int, str]]:
    return [(int(part or 0), text) for text, part in re.findall(r"(\D*)(\d*)", path.stem)]
