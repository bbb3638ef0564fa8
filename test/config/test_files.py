# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Parameter files in both forms, broken ones, and that what is generated is up to date."""

from pathlib import Path

import pytest
import yaml

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.config.documentation import (
    PARAMETER_FILE,
    README,
    parameter_file,
    parameter_table,
    with_table,
)
from msss_graphslam.config.files import read_parameters, ros_parameters
from msss_graphslam.errors import UserError

ROOT = Path(__file__).parents[2]
CHANGED = Configuration().with_values(
    {
        "dead_reckoning.surge_speed": -0.25,
        "dead_reckoning.depth_noise": 1e-6,
        "sensors.gauge_pressure": True,
        "sonar.intensity_scale": "linear",
    }
)


def written(path: Path, text: str) -> Path:
    path.write_text(text, encoding="utf-8")
    return path


def test_what_is_written_for_ros_reads_back_as_it_was(tmp_path: Path) -> None:
    path = written(tmp_path / "parameters.yaml", ros_parameters(CHANGED))
    assert Configuration().with_values(read_parameters(path)) == CHANGED


def test_plain_groups_read_as_they_were(tmp_path: Path) -> None:
    path = written(tmp_path / "parameters.yaml", yaml.safe_dump(CHANGED.as_dict()))
    assert Configuration().with_values(read_parameters(path)) == CHANGED


def test_every_float_keeps_its_point_for_ros() -> None:
    parameters = yaml.safe_load(ros_parameters(CHANGED))["/**"]["ros__parameters"]
    kinds = {info.name: info.kind for info in Configuration.parameters()}
    assert {
        f"{group}.{name}": type(value)
        for group, values in parameters.items()
        for name, value in values.items()
    } == kinds


@pytest.mark.parametrize(
    "text",
    [
        "/**:\n  ros__parameters:\n    sonar.mount_x: 0.5\n",
        "/sonar/front_end:\n  ros__parameters:\n    sonar: {mount_x: 0.5}\n",
        "sonar.mount_x: 0.5\n",
        "sonar: {mount_x: 5e-1}\n",
    ],
)
def test_the_forms_that_people_write(tmp_path: Path, text: str) -> None:
    values = read_parameters(written(tmp_path / "parameters.yaml", text))
    assert Configuration().with_values(values).sonar.mount_x == 0.5


def test_an_empty_file_changes_nothing(tmp_path: Path) -> None:
    assert read_parameters(written(tmp_path / "empty.yaml", "# nothing\n")) == {}


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"a: b: c", "not a YAML file"),
        (b"\xff\xfe\x00sonar", "not a YAML file"),
        (b"sonar: !!python/object/apply:os.getcwd []", "not a YAML file"),
        (b"- sonar\n- imu\n", "not a list"),
        (b"sonar", "not a single value"),
        (b"3.5", "not a single value"),
    ],
)
def test_a_file_of_another_kind_is_named_in_one_line(
    tmp_path: Path, content: bytes, message: str
) -> None:
    path = tmp_path / "parameters.yaml"
    path.write_bytes(content)
    with pytest.raises(UserError) as caught:
        read_parameters(path)
    assert str(caught.value).startswith(f"{path}: ")
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"nothing\.yaml: cannot be read"):
        read_parameters(tmp_path / "nothing.yaml")


def test_the_parameter_file_is_up_to_date() -> None:
    assert (ROOT / PARAMETER_FILE).read_text(encoding="utf-8") == parameter_file()


def test_the_table_of_the_readme_is_up_to_date() -> None:
    readme = (ROOT / README).read_text(encoding="utf-8")
    assert with_table(readme) == readme


def test_the_table_has_a_row_for_every_parameter() -> None:
    rows = [line for line in parameter_table().splitlines() if line.startswith("| `")]
    assert len(rows) == len(Configuration.parameters())


def test_a_readme_without_the_marks_is_an_error() -> None:
    with pytest.raises(ValueError, match="the README must hold"):
        with_table("# A README\n")
