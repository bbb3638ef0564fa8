# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What the documents name exists."""

import re
from functools import reduce
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest

from msss_graphslam.messages.columns import BEAMS, POSES, SETTLED
from msss_graphslam.messages.topics import LINKS, OUTPUTS, Topic

ROOT = Path(__file__).parents[2]
PAPER_TO_CODE = (ROOT / "docs" / "paper_to_code.md").read_text(encoding="utf-8")
PACKAGES = "core|config|evaluation|results|simulation|recordings|messages|offline|ros|nodes|live"
NAMES = sorted(set(re.findall(rf"`((?:{PACKAGES})\.[\w.]+)`", PAPER_TO_CODE)))
DOCUMENTS = [
    "README.md",
    "CONTRIBUTING.md",
    "bags/README.md",
    "docs/ablation.md",
    "docs/accuracy.md",
    "docs/consistency.md",
    "docs/live.md",
    "docs/long_missions.md",
    "docs/micron.md",
    "docs/paper_to_code.md",
    "docs/recordings.md",
    "docs/reproduction.md",
    "docs/robustness.md",
    "docs/sidelobe_ring.md",
]


def look_up(name: str) -> object:
    """Return the module, or what a module holds; AttributeError where there is no such thing."""
    parts = f"msss_graphslam.{name}".split(".")
    for length in range(len(parts), 1, -1):
        try:
            module = import_module(".".join(parts[:length]))
        except ModuleNotFoundError:
            continue
        return reduce(getattr, parts[length:], module)
    raise AttributeError(name)


@pytest.mark.parametrize("name", NAMES)
def test_what_the_paper_is_mapped_to_exists(name: str) -> None:
    assert look_up(name) is not None


def test_every_package_has_its_row_in_the_layout() -> None:
    layout = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8").partition("## Layout")[2]
    rows = re.findall(r"^\| `(\w+)` \|", layout.partition("## Rules")[0], re.MULTILINE)
    package = ROOT / "msss_graphslam"
    places = [*package.glob("*/__init__.py"), *package.glob("core/*/__init__.py")]
    packages = {path.parent.name for path in places}
    assert sorted(rows) == sorted(packages)


@pytest.mark.parametrize("name", ["core.matching.spic.no_such_thing", "core.no_such_module"])
def test_a_name_that_does_not_exist_would_be_noticed(name: str) -> None:
    with pytest.raises(AttributeError):
        look_up(name)


@pytest.mark.parametrize("number", range(1, 16))
def test_every_equation_has_its_place(number: int) -> None:
    equations = PAPER_TO_CODE.partition("## Equations")[2].partition("## Symbols")[0]
    assert f"({number})" in equations


@pytest.mark.parametrize("number", range(1, 17))
def test_every_figure_has_its_place(number: int) -> None:
    figures = PAPER_TO_CODE.partition("## Figures")[2].partition("## Beyond")[0]
    rows = [line.split("|")[1] for line in figures.splitlines() if line.startswith("| ")]
    assert str(number) in re.findall(r"\d+", " ".join(rows))


@pytest.mark.parametrize("document", DOCUMENTS)
def test_links_to_files_lead_somewhere(document: str) -> None:
    path = ROOT / document
    targets = re.findall(r"\]\((?!https?:)([^)#]+)", path.read_text(encoding="utf-8"))
    assert [target for target in targets if not (path.parent / target).exists()] == []


def assert_in_table(topic: Topic, section: str) -> None:
    """Assert that one row names topic, type and delivery."""
    kind = topic.type_name.replace("/msg/", "/")
    named = re.compile(rf"`/?{topic.name}`.*`{kind}`")
    rows = [line for line in section.splitlines() if named.search(line)]
    assert len(rows) == 1
    assert ("latched" in rows[0] or "deep" in rows[0]) == topic.latched


@pytest.mark.parametrize("topic", OUTPUTS, ids=lambda topic: topic.label)
def test_every_output_stands_in_the_readme(topic: Topic) -> None:
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    assert_in_table(topic, text.partition("## On a vehicle")[2].partition("\n## ")[0])


@pytest.mark.parametrize("topic", LINKS, ids=lambda topic: topic.label)
def test_every_link_of_the_nodes_is_explained(topic: Topic) -> None:
    text = (ROOT / "docs" / "live.md").read_text(encoding="utf-8")
    assert_in_table(topic, text.partition("## Links between the nodes")[2].partition("\n## ")[0])


@pytest.mark.parametrize(
    ("name", "layout"),
    [("odom/settled", SETTLED), ("scan/beams", BEAMS), ("graph/poses", POSES)],
)
def test_every_column_of_a_link_is_explained(name: str, layout: np.dtype[np.void]) -> None:
    text = (ROOT / "docs" / "live.md").read_text(encoding="utf-8")
    row = re.findall(rf"^\| `{name}` \|.* stamp, (.*) \|", text, re.MULTILINE)[0]
    named = re.findall(r"`(\w+)`(?: \((\d+)\))?", row)
    told = {column: int(count or 1) for column, count in named}
    columns = [column for column in layout.names or () if column not in ("sec", "nanosec")]
    assert told == {column: int(np.prod(layout[column].shape)) for column in columns}
