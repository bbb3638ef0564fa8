# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
from dataclasses import replace

import numpy as np
import pytest
from promised_files import ESTIMATE_FILES
from synthetic_run import synthetic_run, without_keyframes

from msss_graphslam.errors import UserError
from msss_graphslam.results.atomic import replacing
from msss_graphslam.results.directory import ResultDirectory


@pytest.fixture(scope="module")
def record():
    return synthetic_run(3)


def names(path):
    return {entry.name for entry in path.iterdir()}


def test_a_run_leaves_the_promised_files_and_no_others(tmp_path, record):
    ResultDirectory.create(tmp_path / "a" / "b").write_estimate(record)
    assert names(tmp_path / "a" / "b") == ESTIMATE_FILES


def test_trajectories_are_read_back(tmp_path, record):
    directory = ResultDirectory.create(tmp_path)
    directory.write_estimate(record)
    corrected, online, dead_reckoning = directory.read_trajectories()
    for read, written in (
        (corrected, record.estimate.trajectory),
        (online, record.estimate.online),
        (dead_reckoning, record.estimate.dead_reckoning),
    ):
        np.testing.assert_array_equal(read.stamps_ns, written.stamps_ns)
        np.testing.assert_allclose(read.poses[:, :3], written.poses[:, :3], atol=1e-9)


def test_a_second_run_leaves_the_same_bytes(tmp_path, record):
    for name in ("one", "other"):
        ResultDirectory.create(tmp_path / name).write_estimate(record)
    for name in ESTIMATE_FILES:
        one, other = (tmp_path / run / name for run in ("one", "other"))
        assert one.read_bytes() == other.read_bytes(), name


def test_less_than_a_turn_still_leaves_every_file(tmp_path, record):
    ResultDirectory.create(tmp_path).write_estimate(without_keyframes(record))
    assert names(tmp_path) == ESTIMATE_FILES
    assert (tmp_path / "keyframes.tum").read_text() == ""


def test_keyframes_lie_at_their_first_beams(record):
    keyframes = record.keyframe_trajectory
    first = [frame.scan.beam_stamps_ns[0] for frame in record.estimate.keyframes]
    assert keyframes.stamps_ns.tolist() == first
    assert np.all(keyframes.poses[:, 2] == -1.5)


def test_the_summary_is_read_back_and_never_holds_nan(tmp_path):
    directory = ResultDirectory.create(tmp_path)
    directory.write_summary({"beams": 3})
    with pytest.raises(ValueError, match="not JSON compliant"):
        directory.write_summary({"beams": float("nan")})
    assert directory.read_summary() == {"beams": 3}
    assert names(tmp_path) == {"summary.json"}


@pytest.mark.parametrize("content", [None, "{", "[1]", "\x00"])
def test_a_broken_summary_is_refused(tmp_path, content):
    if content is not None:
        (tmp_path / "summary.json").write_text(content)
    with pytest.raises(UserError, match="summary"):
        ResultDirectory(tmp_path).read_summary()


def test_reading_what_is_not_there_says_so(tmp_path):
    with pytest.raises(UserError, match="no such directory"):
        ResultDirectory(tmp_path / "none").read_trajectories()
    with pytest.raises(UserError, match=r"trajectory\.tum: no such file"):
        ResultDirectory(tmp_path).read_trajectories()


def test_a_file_in_the_way_of_the_directory_is_reported(tmp_path):
    (tmp_path / "out").write_text("in the way")
    with pytest.raises(UserError, match="cannot make this directory"):
        ResultDirectory.create(tmp_path / "out")


def test_a_failed_write_leaves_what_was_there(tmp_path):
    path = tmp_path / "file.txt"
    path.write_text("before")

    def write_half():
        with replacing(path) as temporary:
            temporary.write_text("half")
            raise OSError("disk full")

    with pytest.raises(OSError, match="disk full"):
        write_half()
    assert path.read_text() == "before"
    assert names(tmp_path) == {"file.txt"}


def test_a_singular_covariance_cannot_pass_as_a_graph(tmp_path, record):
    broken = replace(record.estimate.constraints[0], covariance=np.zeros((3, 3)))
    estimate = replace(record.estimate, constraints=(broken,))
    with pytest.raises(np.linalg.LinAlgError):
        ResultDirectory.create(tmp_path).write_estimate(replace(record, estimate=estimate))
    assert "graph.g2o" not in names(tmp_path)
