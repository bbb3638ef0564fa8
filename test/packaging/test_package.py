# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What the package says of itself agrees with what it is."""

import ast
import re
import sys
from pathlib import Path

import pytest

from msss_graphslam import __version__

ROOT = Path(__file__).parents[2]
SOURCES = sorted((ROOT / "msss_graphslam").rglob("*.py"))
PYPI_NAMES = {"serial": "pyserial", "yaml": "pyyaml"}
CORE_MAY_USE = {"gtsam", "msss_graphslam", "numba", "numpy", "scipy"}
"""Beside the parts of the standard library that compute, and touch nothing outside."""
CORE_MAY_USE |= {
    "array",
    "bisect",
    "cmath",
    "collections",
    "contextlib",
    "copy",
    "dataclasses",
    "enum",
    "functools",
    "heapq",
    "itertools",
    "math",
    "typing",
}


def imported(path: Path) -> set[str]:
    """Return the top-level packages that a file imports."""
    names = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names |= {alias.name.partition(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            names.add((node.module or "").partition(".")[0])
    return names


def required() -> set[str]:
    """Return the install_requires of setup.py."""
    tree = ast.parse((ROOT / "setup.py").read_text(encoding="utf-8"))
    lists = [
        node.value
        for node in ast.walk(tree)
        if isinstance(node, ast.keyword) and node.arg == "install_requires"
    ]
    return set(ast.literal_eval(lists[0]))


def of_ros() -> set[str]:
    """Return the ROS packages that package.xml names; those of Debian are named python3-*."""
    text = (ROOT / "package.xml").read_text(encoding="utf-8")
    named = set(re.findall("<exec_depend>(.*)</exec_depend>", text))
    return {name for name in named if not name.startswith("python3-")}


def pinned(name: str) -> set[str]:
    """Return the packages that a requirements file names, also those it takes from another."""
    text = (ROOT / "requirements" / name).read_text(encoding="utf-8")
    names = set(re.findall(r"^([a-zA-Z][\w.-]*)", text, flags=re.MULTILINE))
    for other in re.findall(r"^-r (\S+)", text, flags=re.MULTILINE):
        names |= pinned(other)
    return names


def test_package_xml_names_the_same_version() -> None:
    text = (ROOT / "package.xml").read_text(encoding="utf-8")
    assert re.findall("<version>(.*)</version>", text) == [__version__]


def test_what_is_imported_is_required_and_nothing_else() -> None:
    used = {name for path in SOURCES for name in imported(path)}
    foreign = used - set(sys.stdlib_module_names) - {"msss_graphslam"}
    assert {PYPI_NAMES.get(name, name) for name in foreign - of_ros()} == required()


def test_packages_of_ros_are_not_pips_to_find() -> None:
    assert "rclpy" in of_ros()
    assert required().isdisjoint(of_ros())


@pytest.mark.parametrize("flavour", ["wheels.txt", "jazzy.txt"])
def test_every_requirement_is_in_both_flavours_of_the_environment(flavour: str) -> None:
    assert required() <= pinned(flavour)


@pytest.mark.parametrize("name", ["base.txt", "wheels.txt"])
def test_versions_are_exact_and_each_has_its_reason(name: str) -> None:
    text = (ROOT / "requirements" / name).read_text(encoding="utf-8")
    lines = [line for line in text.splitlines() if line and line[0] not in "#-"]
    assert [line for line in lines if not re.fullmatch(r"\S+==[\w.]+ +# .{5,}", line)] == []


@pytest.mark.parametrize(
    "path",
    [path for path in SOURCES if "core" in path.relative_to(ROOT).parts],
    ids=lambda path: path.stem,
)
def test_the_core_only_computes(path: Path) -> None:
    assert imported(path) <= CORE_MAY_USE
    tree = ast.parse(path.read_text(encoding="utf-8"))
    called = {
        node.func.id
        for node in ast.walk(tree)
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name)
    }
    assert called.isdisjoint({"print", "open", "input", "exec", "eval"})


@pytest.mark.parametrize("path", SOURCES, ids=lambda path: str(path.relative_to(ROOT)))
def test_every_file_carries_its_licence(path: Path) -> None:
    lines = path.read_text(encoding="utf-8").splitlines()
    assert lines[0] == "# SPDX-FileCopyrightText: 2026 The msss_graphslam authors"
    assert lines[1] == "# SPDX-License-Identifier: Apache-2.0"
