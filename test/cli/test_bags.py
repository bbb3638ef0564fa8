# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The commands that look at bags: what they say of good, damaged and hopeless ones."""

import json
from pathlib import Path

import pytest
from command_line import assert_one_line, msss

from msss_graphslam.simulation.recording import SimulatedBag


def test_inspect_tells_the_heads_settings(tank: SimulatedBag) -> None:
    done = msss("inspect", tank.bag)
    assert (done.returncode, done.stderr) == (0, "")
    assert "100 bins to 9.95 m" in done.stdout
    assert "3.60 deg a step, counter-clockwise, 4.00 s a turn" in done.stdout
    assert "missing /dvl/twist: speed is assumed" in done.stdout


def test_inspect_as_json(tank: SimulatedBag) -> None:
    report = json.loads(msss("inspect", tank.bag, "--json").stdout)
    assert report["can_run"] is True
    counts = {topic["name"]: topic["count"] for topic in report["topics"]}
    assert counts["/sonar/ping"] == report["sonar"]["beams"]
    assert report["refused"] == {}


def test_inspect_names_the_damage_of_a_truncated_bag(truncated: Path) -> None:
    done = msss("inspect", truncated)
    assert done.returncode == 3
    assert "the file ends early" in done.stderr


def test_salvage_keeps_what_is_whole(truncated: Path, tank: SimulatedBag, tmp_path: Path) -> None:
    done = msss("salvage", truncated, tmp_path / "saved", "--json")
    assert done.returncode == 3
    saved = json.loads(done.stdout)
    assert "the file ends early" in saved["damage"]
    again = msss("inspect", tmp_path / "saved", "--json")
    assert again.returncode == 0
    counts = {topic["name"]: topic["count"] for topic in json.loads(again.stdout)["topics"]}
    assert counts == saved["messages"]
    whole = json.loads(msss("inspect", tank.bag, "--json").stdout)
    assert 0 < counts["/sonar/ping"] < whole["sonar"]["beams"]


def test_salvage_of_a_whole_bag_is_clean(tank: SimulatedBag, tmp_path: Path) -> None:
    done = msss("salvage", tank.bag, tmp_path / "saved")
    assert (done.returncode, done.stderr) == (0, "")
    assert "/sonar/ping" in done.stdout


def test_salvage_overwrites_nothing(tank: SimulatedBag, tmp_path: Path) -> None:
    done = msss("salvage", tank.bag, tmp_path)
    assert_one_line(done)


def test_quiet_says_nothing(tank: SimulatedBag) -> None:
    done = msss("inspect", tank.bag, "--quiet")
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("empty.mcap", b""),
        ("text.mcap", b"a line of text, and no bag\n"),
        ("magic.mcap", b"\x89MCAP0\r\n"),
        ("old.bag", b"#ROSBAG V2.0\nE\x00\x00\x00"),
    ],
)
def test_what_is_no_bag_is_named(tmp_path: Path, name: str, content: bytes) -> None:
    path = tmp_path / name
    path.write_bytes(content)
    done = msss("inspect", path)
    assert_one_line(done)
    assert str(path) in done.stderr


@pytest.mark.parametrize(
    "arguments",
    [
        ("inspect", "nothing"),
        ("run", "nothing", "--out", "out"),
        ("compare", "nothing", "--out", "out"),
        ("salvage", "nothing", "out"),
        ("convert", "nothing", "out"),
    ],
    ids=lambda arguments: arguments[0],
)
def test_a_missing_bag_is_named_and_nothing_is_left(
    tmp_path: Path, arguments: tuple[str, ...]
) -> None:
    done = msss(*arguments, cwd=tmp_path)
    assert_one_line(done)
    assert "msss: nothing: " in done.stderr
    assert "o such file" in done.stderr
    assert list(tmp_path.iterdir()) == []


def test_a_folder_without_a_bag_is_named(tmp_path: Path) -> None:
    done = msss("inspect", tmp_path)
    assert_one_line(done)


@pytest.mark.parametrize(
    ("content", "said"),
    [
        ("sonar: {mont_x: 1.0}", "did you mean 'sonar.mount_x'?"),
        ("sonar: {mount_yaw: 7.0}", "must lie in [-3.15, 3.15]"),
        ("sonar: [", "not a YAML file"),
    ],
)
def test_a_wrong_parameter_file_is_one_line(
    tank: SimulatedBag, tmp_path: Path, content: str, said: str
) -> None:
    path = tmp_path / "parameters.yaml"
    path.write_text(content, encoding="utf-8")
    done = msss("inspect", tank.bag, "--config", path)
    assert_one_line(done)
    assert f"{path}: " in done.stderr
    assert said in done.stderr
