# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What is written from the configuration: the ROS parameter file and the README's table.

``python -m msss_graphslam.config.documentation`` brings both up to date in the working directory.
"""

from itertools import groupby
from pathlib import Path

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.config.fields import ParameterInfo
from msss_graphslam.config.files import ros_parameters

__all__ = [
    "PARAMETER_FILE",
    "README",
    "parameter_file",
    "parameter_table",
    "with_table",
]

PARAMETER_FILE = Path("config", "msss_graphslam.yaml")
README = Path("README.md")

_COMMAND = "python -m msss_graphslam.config.documentation"
_BEGIN = f"<!-- parameters: made by `{_COMMAND}` -->"
_END = "<!-- end of parameters -->"


def parameter_file() -> str:
    """Return the text of the ROS parameter file with every default."""
    heading = f"# The defaults of every parameter, made by `{_COMMAND}`.\n"
    return heading + ros_parameters(Configuration())


def parameter_table() -> str:
    """Return the parameters as Markdown, a table a group."""
    parameters = Configuration.parameters()
    by_group = groupby(parameters, key=lambda info: info.name.partition(".")[0])
    return "\n".join(_group_table(name, list(group)) for name, group in by_group)


def with_table(readme: str) -> str:
    """Return the README with the tables between its two marks made anew."""
    before, begin, rest = readme.partition(_BEGIN)
    _, end, after = rest.partition(_END)
    if not (begin and end):
        raise ValueError(f"the README must hold {_BEGIN!r} and {_END!r}")
    return f"{before}{_BEGIN}\n\n{parameter_table()}\n{_END}{after}"


def _group_table(name: str, parameters: list[ParameterInfo]) -> str:
    heading = [
        f"**`{name}`**",
        "",
        "| name | default | unit | range | meaning |",
        "|---|---|---|---|---|",
    ]
    return "\n".join(heading + [_row(info) for info in parameters]) + "\n"


def _row(info: ParameterInfo) -> str:
    name = info.name.partition(".")[2]
    meaning = f"{info.meaning} ({info.source})" if info.source else info.meaning
    cells = (f"`{name}`", f"`{info.default}`", info.unit, info.range_text, meaning)
    return "| " + " | ".join(cell.replace("|", r"\|") for cell in cells) + " |"


def main() -> None:
    """Write both files in the working directory."""
    PARAMETER_FILE.parent.mkdir(exist_ok=True)
    PARAMETER_FILE.write_text(parameter_file(), encoding="utf-8")
    README.write_text(with_table(README.read_text(encoding="utf-8")), encoding="utf-8")


if __name__ == "__main__":
    main()
