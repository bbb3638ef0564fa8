# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest
import yaml
from PIL import Image

from msss_graphslam.core.maps.mapping import OccupancyGrid
from msss_graphslam.results.occupancy_map import write_occupancy_map
from msss_graphslam.results.point_cloud import write_points


def read_ply(path):
    """Read the vertices as the header describes them."""
    header, _, body = path.read_bytes().partition(b"end_header\n")
    lines = header.decode().splitlines()
    assert lines[:2] == ["ply", "format binary_little_endian 1.0"]
    count = next(int(line.split()[2]) for line in lines if line.startswith("element vertex"))
    properties = [line.split() for line in lines if line.startswith("property")]
    assert [kind for _, kind, _ in properties] == ["float"] * 3
    assert [name for *_, name in properties] == ["x", "y", "z"]
    assert len(body) == count * 12
    return np.frombuffer(body, dtype="<f4").reshape(count, 3)


@pytest.mark.parametrize("columns", [2, 3])
def test_points_come_back_in_single_precision(tmp_path, columns):
    points = np.random.default_rng(3).uniform(-500.0, 500.0, (200, columns))
    write_points(tmp_path / "map.ply", points)
    read = read_ply(tmp_path / "map.ply")
    np.testing.assert_allclose(read[:, :columns], points, atol=5e-5)
    assert np.all(read[:, columns:] == 0.0)


def test_a_map_without_points_is_a_valid_file(tmp_path):
    write_points(tmp_path / "map.ply", np.zeros((0, 2)))
    assert read_ply(tmp_path / "map.ply").shape == (0, 3)


def as_map_server_reads(directory):
    """Return occupied, free and unknown cells, row 0 southmost, by map_server's rule."""
    description = yaml.safe_load((directory / "map.yaml").read_text())
    grey = np.asarray(Image.open(directory / description["image"]), dtype=float)[::-1]
    probability = (255.0 - grey) / 255.0
    occupied = probability > description["occupied_thresh"]
    free = probability < description["free_thresh"]
    return np.where(occupied, 1, np.where(free, 0, -1)), description


def test_map_server_reads_the_grid_north_up_and_in_place(tmp_path):
    cells = np.array([[-1, 0, 100], [19, 20, 65]], dtype=np.int8)
    grid = OccupancyGrid(cells, 0.25, np.array([-3.0, 4.5]))
    write_occupancy_map(tmp_path / "map.pgm", tmp_path / "map.yaml", grid)
    read, description = as_map_server_reads(tmp_path)
    assert read.tolist() == [[-1, 0, 1], [0, -1, -1]]
    assert description["resolution"] == 0.25
    assert description["origin"] == [-3.0, 4.5, 0.0]
    assert description["negate"] == 0


def test_a_cell_is_a_wall_above_the_threshold_only(tmp_path):
    grid = OccupancyGrid(np.array([[65, 66]], dtype=np.int8), 0.1, np.zeros(2))
    write_occupancy_map(tmp_path / "map.pgm", tmp_path / "map.yaml", grid)
    assert as_map_server_reads(tmp_path)[0].tolist() == [[-1, 1]]


def test_an_empty_grid_is_one_unknown_cell(tmp_path):
    grid = OccupancyGrid(np.zeros((0, 0), dtype=np.int8), 0.1, np.zeros(2))
    write_occupancy_map(tmp_path / "map.pgm", tmp_path / "map.yaml", grid)
    assert as_map_server_reads(tmp_path)[0].tolist() == [[-1]]
