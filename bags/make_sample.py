# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Make the sample bag and note its checksum: ``python bags/make_sample.py``."""

import hashlib
import re
import shutil
import tempfile
from dataclasses import replace
from pathlib import Path

from msss_graphslam.simulation.recording import simulate
from msss_graphslam.simulation.worlds import world_named

FOLDER = Path(__file__).parent
SAMPLE = FOLDER / "pond"
SEED = 2
BINS = 200
"""A setting of the head: 10 cm a bin to 20 m; the pond of the paper was scanned with 5.7 cm."""


def main() -> None:
    """Write the bag in place of the one that is there, and its checksum into the README."""
    pond = world_named("pond")
    with tempfile.TemporaryDirectory() as scratch:
        sonar = replace(pond.sonar, bins=BINS)
        made = simulate(pond, SEED, Path(scratch), sonar=sonar, raw=True)
        shutil.rmtree(SAMPLE, ignore_errors=True)
        shutil.move(made.bag, SAMPLE)
    content = next(SAMPLE.glob("*.mcap")).read_bytes()
    readme = FOLDER / "README.md"
    noted = re.sub(r"\b[0-9a-f]{64}\b", hashlib.sha256(content).hexdigest(), readme.read_text())
    readme.write_text(noted)


if __name__ == "__main__":
    main()
