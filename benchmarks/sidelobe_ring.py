# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What the sidelobe ring says of the nearest wall: writes docs/sidelobe_ring.md."""

from argparse import ArgumentParser
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from benchmarks.campaign import Provenance, add_flights, call, flights_in
from benchmarks.flights import Flight
from benchmarks.missions import Mission
from benchmarks.page import rendered
from benchmarks.result_cache import fingerprint, sources
from benchmarks.ring_finding import WINDOW, Windows, nearest_wall, windows_of
from benchmarks.tables import Table
from msss_graphslam.cli.console import Console
from msss_graphslam.config.configuration import Configuration
from msss_graphslam.core.compounding import wrap
from msss_graphslam.core.types import Array, Beam
from msss_graphslam.evaluation.errors import interpolate
from msss_graphslam.recordings.reader import open_recording
from msss_graphslam.simulation.echo_model import EchoKind

__all__ = ["ASIDE", "deviation", "main", "recorded_row", "ring_page", "simulated_rows"]

AHEAD = (("sector", 2.0 * np.pi / 3.0),)
MISSIONS = tuple(
    Mission(world, EchoKind.REAL, 1, sonar=sonar)
    for world, sonar in (
        ("pond", ()),
        ("pond", AHEAD),
        ("paper", ()),
        ("cave", ()),
        ("marina", ()),
    )
)

ASIDE = np.radians(60.0)
"""Windows this far off the nearest wall's direction do not see it with the main beam."""

BEAMS = 6000
"""So many beams of a simulated mission are looked at: thirty turns."""

OUTLIER = 0.5
"""What is farther off is another surface than the nearest [m]."""

HEADER = ["mission", "windows", "ring found", "within 0.5 m", "bias [m]", "deviation [m]"]


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure in simulated missions, and in recordings that are given; write the page."""
    parser = ArgumentParser(prog="python -m benchmarks.sidelobe_ring", description=__doc__)
    parser.add_argument(
        "recordings", nargs="*", type=Path, help="bags of real heads, made by `msss convert`"
    )
    add_flights(parser)
    parser.add_argument("--page", type=Path, default=Path("docs", "sidelobe_ring.md"))
    options = parser.parse_args(arguments)
    flights = flights_in(options.flights)
    simulated, recorded, total = [], [], len(MISSIONS) + len(options.recordings)
    with Console().progress() as progress:
        for number, mission in enumerate(MISSIONS):
            progress(number / total, str(mission))
            simulated += simulated_rows(mission, flights.get(mission))
        for number, path in enumerate(options.recordings, len(MISSIONS)):
            progress(number / total, path.name)
            recorded.append(recorded_row(path))
    command = " ".join([parser.prog, *(path.name for path in options.recordings)])
    provenance = Provenance.of(command, fingerprint(sources()))
    options.page.write_text(ring_page(simulated, recorded, provenance), encoding="utf-8")


def simulated_rows(mission: Mission, flight: Flight) -> list[list[str]]:
    """Return the ring in all windows and in those that look aside, and the nearest echo."""
    beams = [entry for entry in flight.measurements() if isinstance(entry, Beam)]
    windows = windows_of(beams[:BEAMS])
    poses = interpolate(flight.truth, windows.stamps_ns)[0]
    true, azimuths = nearest_wall(poses[:, :2], mission.place.walls)
    aside = np.abs(wrap(poses[:, 2] + windows.bearings - azimuths)) > ASIDE
    return [
        _row(f"{mission}, ring", windows.rings - true),
        _row(f"{mission}, ring, looking aside", (windows.rings - true)[aside]),
        _row(f"{mission}, nearest echo of the turn", windows.echoes - true),
    ]


def recorded_row(path: Path) -> list[str]:
    """Return the ring against the nearest echo of its turn, in a recording without truth."""
    refused: Counter[str] = Counter()
    measurements = open_recording(path).measurements(refused, Configuration())
    windows: Windows = windows_of([entry for entry in measurements if isinstance(entry, Beam)])
    return _row(path.stem, windows.rings - windows.echoes)


def ring_page(
    simulated: Sequence[list[str]], recorded: Sequence[list[str]], provenance: Provenance
) -> str:
    """Return the page as Markdown."""
    return rendered(
        "sidelobe_ring.md.jinja",
        provenance=provenance,
        window=WINDOW,
        beams=BEAMS,
        aside=f"{np.degrees(ASIDE):.0f}",
        simulated=Table("simulated", HEADER, simulated).markdown(),
        recorded=Table("recorded", ["recording", *HEADER[1:]], recorded).markdown()
        if recorded
        else "",
    )


def deviation(values: Array) -> float:
    """Return the standard deviation, of most values alone (from their median deviation)."""
    return 1.4826 * float(np.median(np.abs(values - np.median(values))))


def _row(name: str, errors: Array) -> list[str]:
    found = np.isfinite(errors)
    near = errors[found & (np.abs(errors) < OUTLIER)]
    figures = [f"{np.median(near):.3f}", f"{deviation(near):.3f}"] if len(near) else ["", ""]
    shares = [f"{100.0 * count / max(len(errors), 1):.0f} %" for count in (found.sum(), len(near))]
    return [name, str(len(errors)), *shares, *figures]


if __name__ == "__main__":
    call(main)
