# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Bags like those of the Girona caves data set, written by its definitions."""

from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
from rosbags.rosbag1 import Writer
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from scipy.spatial.transform import Rotation

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.recordings.conversion import ConversionReport, convert
from msss_graphslam.recordings.reader import open_recording

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
