# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Make the sample bag: ``python bags/make_sample.py`` (``make sample-bag``)."""

import shutil
import tempfile
from dataclasses import replace
from pathlib import Path

from msss_graphslam.simulation.recording import simulate
from msss_graphslam.simulation.worlds import world_named

SAMPLE = Path(__file__).with_name("pond")
SEED = 1
BINS = 160
"""A setting of the head: 12.5 cm a bin to 20 m; the pond of the paper was scanned with 5.7 cm."""


def main() -> None:
    """Write the bag, in place of the one that is there."""
    pond = world_named("pond")
    with tempfile.TemporaryDirectory() as scratch:
        made = simulate(pond, SEED, Path(scratch), sonar=replace(pond.sonar, bins=BINS))
        shutil.rmtree(SAMPLE, ignore_errors=True)
        shutil.move(made.bag, SAMPLE)


if __name__ == "__main__":
    main()
