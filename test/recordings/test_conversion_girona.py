# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The Girona caves data set: bags written here by its definitions, from known motion."""

from collections import Counter
from math import isclose, nan, pi, radians
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rosbags.rosbag1 import Writer
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from scipy.spatial.transform import Rotation

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.recipes import ESTIMATORS
from msss_graphslam.core.types import Beam, BodyVelocity, Depth, Inertial
from msss_graphslam.errors import UserError
from msss_graphslam.evaluation.errors import position_errors
from msss_graphslam.offline.estimation import estimate
from msss_graphslam.recordings.conversion import ConversionReport, convert
from msss_graphslam.recordings.mounting import Mounting
from msss_graphslam.recordings.reader import open_recording
from msss_graphslam.recordings.typestore import decode
from msss_graphslam.simulation.recording import SimulatedBag

PACKAGE = "cirs_girona_cala_viuda/msg"
DEFINITIONS = {
    "Depth": "std_msgs/Header header\nfloat64 depth\n",
    "Imu": "std_msgs/Header header\n"
    + "".join(f"float64 {name}\n" for name in ("roll", "pitch", "yaw"))
    + "".join(f"float64 q{axis}\n" for axis in "xyzw")
    + "float64 temp\n"
    + "".join(f"float64 {kind}{axis}\n" for kind in "magb" for axis in "xyz"),
    "LinkquestDvl": """std_msgs/Header header
string errCode
int32[4] dataGood
float64[4] altitudeBeam
float64[4] bottomVelocityBeam
float64[4] waterVelocityBeam
float64[4] waterVelocityCredit
float64[3] velocityInst
int32 velocityInstFlag
float64[3] velocityEarth
int32 velocityEarthFlag
float64[3] waterVelocityInst
int32 waterVelocityInstFlag
float64[3] waterVelocityEarth
int32 waterVelocityEarthFlag
float64 roll
float64 pitch
float64 heading
float64 altitude
float64 temperature
float64 pressure
float64 salinity
float64 soundSpeed
string rawData
""",
}
START_NS = 1_372_687_208_458_031_227

# Axes of the two IMUs on the vehicle, as columns in base_link (forward, port, up).
STARBOARD_FORWARD_UP = np.array([[0, 1, 0], [-1, 0, 0], [0, 0, 1]], dtype=float)
PORT_AFT_UP = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1]], dtype=float)
ENU_TO_NWU = np.array([[0, 1, 0], [-1, 0, 0], [0, 0, 1]], dtype=float)
AXES = {"/imu_adis": STARBOARD_FORWARD_UP, "/imu_xsens_mti": PORT_AFT_UP}

Entry = tuple[str, Any, int]


def ros1_types() -> Any:
    types = get_typestore(Stores.ROS1_NOETIC)
    for name, definition in DEFINITIONS.items():
        types.register(get_types_from_msg(definition, f"{PACKAGE}/{name}"))
    return types


TYPES = ros1_types()


def make(type_name: str, **fields: Any) -> Any:
    """A message; numbers that are left out are 0."""
    known = {}
    for name, (_, detail) in TYPES.fielddefs[type_name][1]:
        base = detail[0][1][0] if isinstance(detail[0], tuple) else detail[0]
        known[name] = np.zeros(detail[1]) if isinstance(detail[0], tuple) else 0.0
        if base == "string":
            known[name] = ""
        elif base.startswith("int"):
            known[name] = np.zeros(detail[1], np.int32) if isinstance(detail[0], tuple) else 0
    return TYPES.types[type_name](**{**known, **fields})


def header(stamp_ns: int) -> Any:
    time = TYPES.types["builtin_interfaces/msg/Time"](
        sec=stamp_ns // 10**9, nanosec=stamp_ns % 10**9
    )
    return TYPES.types["std_msgs/msg/Header"](seq=0, stamp=time, frame_id="sparus")


def scan(stamp_ns: int, angle: float, ranges: Any, codes: Any, maximum: float = 20.0) -> Any:
    return TYPES.types["sensor_msgs/msg/LaserScan"](
        header=header(stamp_ns),
        angle_min=angle,
        angle_max=angle,
        angle_increment=0.0,
        time_increment=0.0,
        scan_time=0.0,
        range_min=0.0,
        range_max=maximum,
        ranges=np.asarray(ranges, dtype=np.float32),
        intensities=np.asarray(codes, dtype=np.float32),
    )


def imu(stamp_ns: int, angles: Any, rates: Any, axes: Any = STARBOARD_FORWARD_UP) -> Any:
    """What an IMU with these axes tells of base_link's angles (ENU) and rates."""
    base = Rotation.from_euler("ZYX", np.asarray(angles)[::-1]).as_matrix()
    x, y, z, w = Rotation.from_matrix(ENU_TO_NWU @ base @ axes).as_quat()
    bias = np.array([0.01, -0.02, 0.03])
    gx, gy, gz = axes.T @ np.asarray(rates) + bias
    bx, by, bz = bias
    fields = {"qx": x, "qy": y, "qz": z, "qw": w, "gx": gx, "gy": gy, "gz": gz}
    fields |= {"bx": bx, "by": by, "bz": bz}
    return make(f"{PACKAGE}/Imu", header=header(stamp_ns), **fields)


def depth(stamp_ns: int, metres: float) -> Any:
    return make(f"{PACKAGE}/Depth", header=header(stamp_ns), depth=metres)


def dvl(stamp_ns: int, velocity: Any, flag: int = 1) -> Any:
    fields = {"velocityInst": np.asarray(velocity, dtype=float), "velocityInstFlag": flag}
    return make(f"{PACKAGE}/LinkquestDvl", header=header(stamp_ns), **fields)


def write(path: Path, entries: list[Entry]) -> Path:
    with Writer(path) as bag:
        topics: dict[str, Any] = {}
        for topic, message, log_ns in entries:
            kind = message.__msgtype__
            if topic not in topics:
                topics[topic] = bag.add_connection(topic, kind, typestore=TYPES)
            bag.write(topics[topic], log_ns, TYPES.serialize_ros1(message, kind))
    return path


def good_scan(index: int = 0, angle: float = 0.5) -> Entry:
    stamp_ns = START_NS + index * 40_000_000
    return "/sonar_micron_ros", scan(stamp_ns, angle, [0.5, 1.0, 1.5], [1, 2, 3]), stamp_ns


def converted(folder: Path, entries: list[Entry]) -> tuple[ConversionReport, list[Any]]:
    source = write(folder / "caves.bag", entries)
    report = convert(source, folder / "out")
    refusals: Counter[str] = Counter()
    found = list(open_recording(folder / "out").measurements(refusals, Configuration()))
    assert not refusals
    return report, found


@pytest.mark.parametrize("topic", AXES)
@pytest.mark.parametrize("angles", [(0, 0, 0), (0.1, -0.2, 0.3), (-0.3, 0.2, 3.0), (0, 0.5, -2.0)])
def test_attitude_and_rates_come_back(tmp_path: Path, topic: str, angles: Any) -> None:
    rates = np.array([0.1, -0.2, 0.3])
    sample = imu(START_NS, angles, rates, AXES[topic])
    report, found = converted(tmp_path, [good_scan(), (topic, sample, START_NS)])
    assert report.messages == {"/sonar/ping": 1, "/imu/data": 1} and not report.refused
    [inertial] = [entry for entry in found if isinstance(entry, Inertial)]
    np.testing.assert_allclose(inertial.orientation, angles, atol=1e-12)
    np.testing.assert_allclose(inertial.angular_velocity, rates, atol=1e-12)
    assert inertial.stamp_ns == START_NS


def test_heading_north_is_a_yaw_of_ninety_degrees(tmp_path: Path) -> None:
    """With x to starboard and north, west, up for axes, an IMU heading north has yaw -90 deg."""
    half = -radians(90) / 2
    fields = {"qz": np.sin(half), "qw": np.cos(half)}
    sample = make(f"{PACKAGE}/Imu", header=header(START_NS), **fields)
    _, found = converted(tmp_path, [good_scan(), ("/imu_adis", sample, START_NS)])
    [inertial] = [entry for entry in found if isinstance(entry, Inertial)]
    np.testing.assert_allclose(inertial.orientation, [0, 0, radians(90)], atol=1e-12)


def test_only_the_better_imu_is_taken_and_odometry_is_no_truth(tmp_path: Path) -> None:
    zeros = np.zeros(3)
    point = TYPES.types["geometry_msgs/msg/Vector3"](x=0.0, y=0.0, z=0.0)
    turn = TYPES.types["geometry_msgs/msg/Quaternion"](x=0.0, y=0.0, z=0.0, w=1.0)
    placed = TYPES.types["geometry_msgs/msg/Transform"](translation=point, rotation=turn)
    pose = TYPES.types["geometry_msgs/msg/TransformStamped"](
        header=header(START_NS), child_frame_id="sparus", transform=placed
    )
    entries = [
        good_scan(),
        ("/imu_xsens_mti", imu(START_NS, zeros, zeros, PORT_AFT_UP), START_NS),
        ("/imu_adis", imu(START_NS, zeros, zeros), START_NS),
        ("/odometry", pose, START_NS),
    ]
    report, _ = converted(tmp_path, entries)
    assert report.messages == {"/sonar/ping": 1, "/imu/data": 1}


def test_depth_and_velocity_come_back(tmp_path: Path) -> None:
    entries = [
        good_scan(),
        ("/depth_sensor", depth(START_NS, 13.9), START_NS),
        ("/dvl_linkquest", dvl(START_NS, [0.3, 0.1, -0.05]), START_NS),
    ]
    _, found = converted(tmp_path, entries)
    [height] = [entry for entry in found if isinstance(entry, Depth)]
    assert isclose(height.z, -13.9, rel_tol=1e-12)
    [speed] = [entry for entry in found if isinstance(entry, BodyVelocity)]
    np.testing.assert_allclose(speed.velocity, [0.3, -0.1, 0.05])


def test_what_is_not_known_is_marked_so(tmp_path: Path) -> None:
    entries = [good_scan(), ("/imu_adis", imu(START_NS, [0, 0, 0], [0, 0, 0]), START_NS)]
    converted(tmp_path, entries)
    messages = {
        raw.channel.topic: decode(raw.data, raw.schema.name)
        for raw in open_recording(tmp_path / "out").messages()
        if raw.schema is not None
    }
    sample = messages["/imu/data"]
    assert sample.header.frame_id == "base_link"
    np.testing.assert_allclose(np.diag(sample.orientation_covariance.reshape(3, 3)), 7.6e-5, 1e-2)
    assert not sample.angular_velocity_covariance.any()
    assert sample.linear_acceleration_covariance[0] == -1.0


@pytest.mark.parametrize(
    ("angle", "bearing"),
    [(pi, 0.0), (pi / 2, pi / 2), (3 * pi / 2, -pi / 2), (0.0, pi), (2 * pi - 0.1, -pi + 0.1)],
)
def test_angles_are_clockwise_from_astern(tmp_path: Path, angle: float, bearing: float) -> None:
    _, [beam] = converted(tmp_path, [good_scan(angle=angle)])
    assert np.exp(1j * beam.bearing) == pytest.approx(np.exp(1j * bearing), abs=1e-6)


@pytest.mark.parametrize(
    "ranges", [[0.0, 0.5, 1.0], [0.25, 0.75, 1.25], [0.5, 1.0, 1.5], []], ids=str
)
def test_bins_begin_at_the_head_whatever_the_ranges_mean(tmp_path: Path, ranges: Any) -> None:
    message = scan(START_NS, 1.0, ranges, [1, 2, 3], maximum=1.5)
    _, [beam] = converted(tmp_path, [("/sonar_micron_ros", message, START_NS)])
    np.testing.assert_allclose(beam.ranges, [0.25, 0.75, 1.25], rtol=1e-6)


BROKEN_SCANS = [
    (scan(START_NS, nan, [0.5, 1.0], [1, 2]), "beam_bearing_not_finite"),
    (scan(START_NS, 0.0, [0.5, nan], [1, 2]), "beam_bins_not_regular"),
    (scan(START_NS, 0.0, [0.5, 2.0], [1, 2]), "beam_bins_not_regular"),
    (scan(START_NS, 0.0, [9.5, 10.0], [1, 2]), "beam_bins_not_regular"),
    (scan(START_NS, 0.0, [0.5, 1.0, 1.2], [1, 2, 3]), "beam_bins_not_regular"),
    (scan(START_NS, 0.0, [1.0, 0.5], [1, 2]), "beam_bins_not_regular"),
    (scan(START_NS, 0.0, [0.0, 0.0], [1, 2]), "beam_bins_not_regular"),
    (scan(START_NS, 0.0, [], [1, 2], maximum=nan), "beam_bins_not_regular"),
    (scan(START_NS, 0.0, [], [1, 2], maximum=0.0), "beam_bins_not_regular"),
    (scan(START_NS, 0.0, [], []), "beam_without_bins"),
    (scan(START_NS, 0.0, [0.5, 1.0], [1, 256]), "beam_intensity_out_of_range"),
    (scan(-(10**9), 0.0, [0.5, 1.0], [1, 2]), "beam_stamp_invalid"),
]
ZEROS = np.zeros(3)
BROKEN_OTHERS = [
    ("/imu_adis", make(f"{PACKAGE}/Imu", header=header(START_NS)), "imu_quaternion_zero"),
    ("/imu_adis", imu(START_NS, ZEROS, [nan, 0, 0]), "imu_not_finite"),
    ("/imu_adis", imu(-(10**9), ZEROS, ZEROS), "imu_stamp_invalid"),
    ("/imu_adis", depth(START_NS, 1.0), "imu_data_undecodable"),
    ("/depth_sensor", depth(START_NS, nan), "pressure_not_finite"),
    ("/depth_sensor", depth(START_NS, -2e4), "pressure_out_of_range"),
    ("/dvl_linkquest", dvl(START_NS, ZEROS, flag=0), "dvl_without_bottom"),
    ("/dvl_linkquest", dvl(START_NS, ZEROS, flag=2), "dvl_without_bottom"),
    ("/dvl_linkquest", dvl(START_NS, [0, nan, 0]), "dvl_not_finite"),
]


@pytest.mark.parametrize(("message", "reason"), BROKEN_SCANS)
def test_scans_that_are_refused(tmp_path: Path, message: Any, reason: str) -> None:
    entries = [good_scan(), ("/sonar_micron_ros", message, START_NS)]
    report, found = converted(tmp_path, entries)
    assert report.refused == {reason: 1} and len(found) == 1


@pytest.mark.parametrize(("topic", "message", "reason"), BROKEN_OTHERS)
def test_samples_that_are_refused(tmp_path: Path, topic: str, message: Any, reason: str) -> None:
    report, found = converted(tmp_path, [good_scan(), (topic, message, START_NS)])
    assert report.refused == {reason: 1} and len(found) == 1


def test_the_mounting_of_the_data_set_gives_way_to_a_given_one(tmp_path: Path) -> None:
    source = write(tmp_path / "caves.bag", [good_scan()])
    convert(source, tmp_path / "own")
    convert(source, tmp_path / "given", Mounting(mount_x=-1.0))
    for name, expected in (("own", 0.1), ("given", -1.0)):
        mounting = open_recording(tmp_path / name).mounting()
        assert mounting is not None and mounting.mount_x == pytest.approx(expected)


def test_without_a_beam_there_is_no_bag(tmp_path: Path) -> None:
    broken = ("/sonar_micron_ros", scan(START_NS, nan, [1.0], [1]), START_NS)
    source = write(tmp_path / "caves.bag", [broken, ("/depth_sensor", depth(0, 1.0), START_NS)])
    with pytest.raises(UserError, match=r"no usable beam.*beam_bearing_not_finite"):
        convert(source, tmp_path / "out")
    assert not (tmp_path / "out").exists()


def as_girona(bag: Path) -> list[Entry]:
    """The measurements of a bag as the data set would hold them; an oracle of its own."""
    entries: list[Entry] = []
    for entry in open_recording(bag).measurements(Counter(), Configuration()):
        stamp_ns = entry.stamp_ns
        if isinstance(entry, Beam):
            message = scan(stamp_ns, pi - entry.bearing, entry.ranges, entry.intensities)
            entries.append(("/sonar_micron_ros", message, stamp_ns))
        elif isinstance(entry, Inertial):
            sample = imu(stamp_ns, entry.orientation, entry.angular_velocity)
            entries.append(("/imu_adis", sample, stamp_ns))
        elif isinstance(entry, Depth):
            entries.append(("/depth_sensor", depth(stamp_ns, -entry.z), stamp_ns))
    return entries


@pytest.mark.slow
def test_a_converted_mission_is_estimated_as_well_as_the_recorded(
    tmp_path: Path, tank: SimulatedBag
) -> None:
    source = write(tmp_path / "caves.bag", as_girona(tank.bag))
    report = convert(source, tmp_path / "out", Mounting())
    assert not report.refused
    record = estimate(
        open_recording(tmp_path / "out"),
        ESTIMATORS["full"],
        Configuration(),
        lambda _share, _what: None,
    )
    truth = open_recording(tank.bag).ground_truth()
    assert truth is not None
    assert position_errors(record.estimate.trajectory, truth).anchored.max() < 0.3
