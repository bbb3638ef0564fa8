# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What a record says of the run that it came from."""

import shlex
from pathlib import Path

from sample_bags import write_bag

from msss_graphslam.cli.main import main
from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.recipes import ESTIMATORS
from msss_graphslam.offline.estimation import estimate
from msss_graphslam.recordings.reader import open_recording
from msss_graphslam.results.directory import ResultDirectory

CHANGED = {"dead_reckoning.surge_speed": 0.25, "sensors.gauge_pressure": True}


def test_the_command_makes_the_same_run_again(tmp_path: Path) -> None:
    bag = write_bag(tmp_path / "a bag")
    configuration = Configuration().with_values(CHANGED)
    record = estimate(open_recording(bag), ESTIMATORS["uspic"], configuration, lambda *_: None)
    program, *words = shlex.split(record.command)
    words[words.index("a bag")] = str(bag)
    assert program == "msss"
    main([*words, "--out", str(tmp_path / "out"), "--quiet"])
    resolved = ResultDirectory(tmp_path / "out").read_summary()["configuration"]
    assert resolved == {"estimator": "uspic", **record.configuration}


def test_the_command_names_nothing_that_is_as_it_always_is(tmp_path: Path) -> None:
    recording = open_recording(write_bag(tmp_path / "bag"))
    record = estimate(recording, ESTIMATORS["full"], Configuration(), lambda *_: None)
    assert record.command == "msss run bag --estimator full"
