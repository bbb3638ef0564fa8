# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The topics of the package by relative name, with their message types and delivery."""

from dataclasses import dataclass

__all__ = [
    "CONSTRAINTS",
    "CORRECTION",
    "DVL",
    "GRAPH_POSES",
    "GROUND_TRUTH",
    "IMU",
    "INPUTS",
    "KEYFRAMES",
    "LINKS",
    "MAP",
    "MAP_POINTS",
    "MARKERS",
    "ODOM",
    "OUTPUTS",
    "PATH",
    "POSE",
    "PRESSURE",
    "RAW_TAKEN",
    "RECENT_BEAMS",
    "RECKONED_PATH",
    "SCAN",
    "SCANS_END",
    "SCANS_TAKEN",
    "SCAN_BEAMS",
    "SCAN_PART",
    "SCAN_PROGRESS",
    "SETTLED_ODOMETRY",
    "SONAR_PING",
    "SONAR_RAW",
    "STATIC_TRANSFORMS",
    "TRANSFORMS",
    "TRIED",
    "Topic",
    "find",
]


@dataclass(frozen=True, slots=True)
class Topic:
    """One topic; a latched one keeps its last message for late subscribers (transient local)."""

    name: str
    type_name: str
    latched: bool = False

    @property
    def absolute(self) -> str:
        """The name in a bag, without a namespace."""
        return f"/{self.name}"

    @property
    def label(self) -> str:
        """The name as one word, for the reasons of refusals."""
        return self.name.replace("/", "_")

    def matches(self, name: str) -> bool:
        """Whether a topic's full name is this one, under any namespace."""
        return name.endswith(self.absolute)


SONAR_PING = Topic("sonar/ping", "sensor_msgs/msg/LaserScan")
SONAR_RAW = Topic("sonar/raw", "std_msgs/msg/UInt8MultiArray")
IMU = Topic("imu/data", "sensor_msgs/msg/Imu")
PRESSURE = Topic("pressure", "sensor_msgs/msg/FluidPressure")
DVL = Topic("dvl/twist", "geometry_msgs/msg/TwistWithCovarianceStamped")
GROUND_TRUTH = Topic("ground_truth", "nav_msgs/msg/Odometry")

STATIC_TRANSFORMS = Topic("tf_static", "tf2_msgs/msg/TFMessage", latched=True)

INPUTS = (SONAR_PING, SONAR_RAW, IMU, PRESSURE, DVL, GROUND_TRUTH, STATIC_TRANSFORMS)

ODOM = Topic("odom", "nav_msgs/msg/Odometry")
SCAN = Topic("scan", "sensor_msgs/msg/PointCloud2", latched=True)
CONSTRAINTS = Topic("graph/constraints", "nav_msgs/msg/Odometry", latched=True)
KEYFRAMES = Topic("graph/keyframes", "nav_msgs/msg/Path", latched=True)
MARKERS = Topic("graph/markers", "visualization_msgs/msg/MarkerArray", latched=True)
POSE = Topic("pose", "geometry_msgs/msg/PoseWithCovarianceStamped")
PATH = Topic("path", "nav_msgs/msg/Path", latched=True)
RECKONED_PATH = Topic("path/dead_reckoning", "nav_msgs/msg/Path", latched=True)
MAP_POINTS = Topic("map/points", "sensor_msgs/msg/PointCloud2", latched=True)
MAP = Topic("map", "nav_msgs/msg/OccupancyGrid", latched=True)
TRANSFORMS = Topic("tf", "tf2_msgs/msg/TFMessage")

OUTPUTS = (
    ODOM,
    SCAN,
    CONSTRAINTS,
    KEYFRAMES,
    MARKERS,
    POSE,
    PATH,
    RECKONED_PATH,
    MAP_POINTS,
    MAP,
    TRANSFORMS,
)

RAW_TAKEN = Topic("sonar/taken", "std_msgs/msg/Header")
RECENT_BEAMS = Topic("sonar/recent", "sensor_msgs/msg/LaserScan", latched=True)
SETTLED_ODOMETRY = Topic("odom/settled", "sensor_msgs/msg/PointCloud2", latched=True)
SCAN_BEAMS = Topic("scan/beams", "sensor_msgs/msg/PointCloud2", latched=True)
SCAN_PART = Topic("scan/part", "sensor_msgs/msg/PointCloud2")
SCAN_PROGRESS = Topic("scan/progress", "std_msgs/msg/Header")
SCANS_END = Topic("scan/end", "std_msgs/msg/Header")
SCANS_TAKEN = Topic("scan/taken", "std_msgs/msg/Header", latched=True)
TRIED = Topic("graph/tried", "diagnostic_msgs/msg/DiagnosticArray", latched=True)
GRAPH_POSES = Topic("graph/poses", "sensor_msgs/msg/PointCloud2", latched=True)
CORRECTION = Topic("graph/correction", "nav_msgs/msg/Odometry", latched=True)

LINKS = (
    RAW_TAKEN,
    RECENT_BEAMS,
    SETTLED_ODOMETRY,
    SCAN_BEAMS,
    SCAN_PART,
    SCAN_PROGRESS,
    SCANS_END,
    SCANS_TAKEN,
    TRIED,
    GRAPH_POSES,
    CORRECTION,
)
"""What the nodes tell each other, without loss."""


def find(name: str) -> Topic | None:
    """Return the topic of a full name, under any namespace, or None for a foreign one.

    Where two names fit (``graph/path`` and ``path``), the longer one is meant.
    """
    fitting = [topic for topic in INPUTS + OUTPUTS if topic.matches(name)]
    return max(fitting, key=lambda topic: len(topic.name), default=None)
