# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from msss_graphslam.core.types import Trajectory
from msss_graphslam.errors import UserError
from msss_graphslam.results.tum import format_trajectory, read_trajectory, write_trajectory

LINE = "1.5 1 2 3 0 0 0 1\n"


def trajectory(stamps, poses):
    return Trajectory(np.array(stamps, dtype=np.int64), np.array(poses, dtype=float))


def test_a_line_is_stamp_position_and_quaternion():
    text = format_trajectory(
        trajectory([1_700_000_000_123_456_789], [[1.0, -2.0, 3.5, 0.0, 0.0, np.pi / 2]])
    )
    assert text == (
        "1700000000.123456789 1.000000000 -2.000000000 3.500000000"
        " 0.000000000 0.000000000 0.707106781 0.707106781\n"
    )


def test_quaternions_have_one_sign_and_zeros_none():
    text = format_trajectory(trajectory([0, 1], [[0, -0.0, -1e-12, 0, 0, 3.5], [0] * 6]))
    assert "-0.000000000" not in text
    assert all(float(line.split()[7]) >= 0.0 for line in text.splitlines())


angles = st.floats(-1.4, 1.4)
poses = st.tuples(*[st.floats(-1e3, 1e3)] * 3, angles, angles, st.floats(-3.1, 3.1))


@given(st.lists(poses, min_size=1, max_size=5), st.integers(-(10**18), 2 * 10**18))
def test_what_is_read_is_what_was_written(tmp_path_factory, rows, start):
    path = tmp_path_factory.mktemp("tum") / "t.tum"
    written = trajectory(start + 7 * np.arange(len(rows)), rows)
    write_trajectory(path, written)
    read = read_trajectory(path)
    np.testing.assert_array_equal(read.stamps_ns, written.stamps_ns)
    np.testing.assert_allclose(read.poses[:, :3], written.poses[:, :3], atol=1e-9)
    np.testing.assert_allclose(read.poses[:, 3:], written.poses[:, 3:], atol=2e-8)


def test_equal_poses_make_equal_bytes():
    rows = np.random.default_rng(1).normal(size=(50, 6))
    one, other = (trajectory(np.arange(50), rows.copy()) for _ in range(2))
    assert format_trajectory(one) == format_trajectory(other)


def test_comments_and_empty_lines_are_passed_over(tmp_path):
    path = tmp_path / "t.tum"
    path.write_text(f"# stamp x y z\n\n{LINE}")
    assert read_trajectory(path).stamps_ns.tolist() == [1_500_000_000]


def test_stamps_keep_their_nanoseconds_and_may_have_exponents(tmp_path):
    path = tmp_path / "t.tum"
    path.write_text(
        "-0.000000002 0 0 0 0 0 0 1\n1.5e0 0 0 0 0 0 0 1\n1700000000.000000001 0 0 0 0 0 0 1"
    )
    assert read_trajectory(path).stamps_ns.tolist() == [
        -2,
        1_500_000_000,
        1_700_000_000_000_000_001,
    ]


@pytest.mark.parametrize(
    ("content", "complaint"),
    [
        ("", "holds no pose"),
        ("# only a comment\n", "holds no pose"),
        ("1 2 3\n", "line 1: expected eight"),
        (LINE + "2 1 2 3 0 0 0\n", "line 2: expected eight"),
        ("1 0 0 0 0 0 0 1 9\n", "expected eight"),
        ("1 x 0 0 0 0 0 1\n", "not a number"),
        ("now 0 0 0 0 0 0 1\n", "not a number"),
        ("1e999 0 0 0 0 0 0 1\n", "not a number"),
        ("nan 0 0 0 0 0 0 1\n", "not a number"),
        ("1 nan 0 0 0 0 0 1\n", "finite"),
        ("1 0 inf 0 0 0 0 1\n", "finite"),
        ("1 0 0 0 0 0 0 0\n", "quaternion is zero"),
        (LINE + LINE, "stamps must increase, but pose 2"),
    ],
)
def test_a_bad_file_is_refused_with_its_line(tmp_path, content, complaint):
    path = tmp_path / "bad.tum"
    path.write_text(content)
    with pytest.raises(UserError, match=complaint):
        read_trajectory(path)


def test_a_missing_or_binary_file_is_refused(tmp_path):
    with pytest.raises(UserError, match="no such file"):
        read_trajectory(tmp_path / "none.tum")
    (tmp_path / "binary.tum").write_bytes(b"\xff\xfe\x00\x80")
    with pytest.raises(UserError, match="cannot be read"):
        read_trajectory(tmp_path / "binary.tum")
    with pytest.raises(UserError, match="cannot be read"):
        read_trajectory(tmp_path)
