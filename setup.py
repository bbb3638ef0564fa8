# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The package for pip and for colcon (ament_python).

ROS packages stand in package.xml alone: pip must not look for them. Exact versions of everything
else stand in ``requirements/``, and nowhere else.
"""

from pathlib import Path

from setuptools import find_packages, setup

NAME = "msss_graphslam"
SHARE = f"share/{NAME}"
ROOT = Path(__file__).parent
NODES = (
    "micron_driver",
    "dead_reckoning",
    "scan_generation",
    "front_end",
    "back_end",
    "bag_replay",
    "bag_recorder",
)


def version() -> str:
    """Return the version that the package itself states."""
    lines = (ROOT / NAME / "__init__.py").read_text(encoding="utf-8").splitlines()
    return next(line for line in lines if line.startswith("__version__")).split('"')[1]


def shared(folder: str, *endings: str) -> tuple[str, list[str]]:
    """Return the files of a folder as they go into the package's share directory."""
    files = (path for ending in endings for path in (ROOT / folder).glob(f"*{ending}"))
    return f"{SHARE}/{folder}", sorted(str(path.relative_to(ROOT)) for path in files)


setup(
    name=NAME,
    version=version(),
    description="Graph SLAM for underwater vehicles with a mechanical scanning sonar",
    author="The msss_graphslam authors",
    license="Apache-2.0",
    python_requires=">=3.11",
    packages=find_packages(include=[NAME, f"{NAME}.*"]),
    package_data={NAME: ["py.typed", "evaluation/templates/*"]},
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{NAME}"]),
        (SHARE, ["package.xml"]),
        shared("config", ".yaml", ".rviz", ".json"),
        shared("launch", ".launch.py"),
    ],
    install_requires=[
        "gtsam",
        "jinja2",
        "matplotlib",
        "mcap",
        "numba",
        "numpy",
        "pyserial",
        "pyyaml",
        "rich",
        "rosbags",
        "scipy",
        "zstandard",
    ],
    extras_require={"test": ["hypothesis", "pytest"]},
    zip_safe=False,
    entry_points={
        "console_scripts": [
            "msss = msss_graphslam.cli.main:main",
            "micron_emulator = msss_graphslam.simulation.emulator.main:main",
            *(f"{node} = msss_graphslam.nodes.{node}:main" for node in NODES),
        ]
    },
)
