# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Whether covariances are honest: errors against what was stated, into docs/consistency.md."""

from argparse import ArgumentParser
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from benchmarks import honesty
from benchmarks.campaign import Provenance, call, flights_in, positive
from benchmarks.flights import FlightCache
from benchmarks.honesty import KINDS, STEPS, Statements, statements
from benchmarks.missions import Mission
from benchmarks.page import rendered
from benchmarks.result_cache import fingerprint, sources
from benchmarks.tables import Table
from msss_graphslam.cli.console import Console
from msss_graphslam.core.types import Array
from msss_graphslam.evaluation.covariance_consistency import StepConsistency, step_consistency
from msss_graphslam.simulation.echo_model import EchoKind

__all__ = ["consistency_page", "consistency_table", "main"]

HEADER = ["", "NEES", "in the band", "above", "below", "error x, y, yaw", "stated x, y, yaw"]


def main(arguments: Sequence[str] | None = None) -> None:
    """Run what is missing, then write the page."""
    parser = ArgumentParser(prog="python -m benchmarks.consistency", description=__doc__)
    parser.add_argument("--seeds", type=positive, default=20, help="missions in the pond")
    parser.add_argument("--paper-seeds", type=positive, default=20, help="in the paper's basin")
    parser.add_argument(
        "--folder",
        type=Path,
        default=Path("reproduction"),
        help="folder of single results and, in `flights`, of simulated missions",
    )
    parser.add_argument("--page", type=Path, default=Path("docs", "consistency.md"))
    options = parser.parse_args(arguments)
    seeds = {"pond": options.seeds, "paper": options.paper_seeds}
    used = fingerprint([*sources(), Path(honesty.__file__ or "")])
    results = {
        world: _complete(world, count, options.folder, used) for world, count in seeds.items()
    }
    command = f"{parser.prog} --seeds {options.seeds} --paper-seeds {options.paper_seeds}"
    provenance = Provenance.of(command, used)
    options.page.write_text(consistency_page(results, provenance), encoding="utf-8")


def consistency_page(results: Mapping[str, Sequence[Statements]], provenance: Provenance) -> str:
    """Return the page as Markdown; ``results`` are by world, a mission each."""
    return rendered(
        "consistency.md.jinja",
        provenance=provenance,
        steps=STEPS,
        bands={world: _band(len(missions)) for world, missions in results.items()},
        counts={world: len(missions) for world, missions in results.items()},
        tables={
            world: consistency_table(world, rows).markdown() for world, rows in results.items()
        },
    )


def consistency_table(world: str, missions: Sequence[Statements]) -> Table:
    """Return a row a kind of statement."""
    return Table(world, HEADER, [_row(kind, missions) for kind in KINDS])


def _row(kind: str, missions: Sequence[Statements]) -> list[str]:
    rows = np.array([mission[kind] for mission in missions])
    errors, covariances = rows[..., :3], rows[..., 3:].reshape(*rows.shape[:2], 3, 3)
    found = step_consistency(errors, covariances)
    shares = [f"{100.0 * share:.0f} %" for share in (found.inside, found.above, found.below)]
    rms = np.sqrt(np.mean(errors**2, axis=(0, 1)))
    # The median: a part of a turn may say nothing at all of a direction.
    stated = np.sqrt(np.median(np.diagonal(covariances, axis1=2, axis2=3), axis=(0, 1)))
    return [KINDS[kind], f"{found.mean:.2f}", *shares, _deviations(rms), _deviations(stated)]


def _deviations(values: Array) -> str:
    return f"{values[0]:.3f} m, {values[1]:.3f} m, {np.degrees(values[2]):.2f}°"


def _band(missions: int) -> str:
    found: StepConsistency = step_consistency(
        np.zeros((missions, 1, 3)), np.tile(np.eye(3), (missions, 1, 1, 1))
    )
    return f"{found.low:.2f} to {found.high:.2f}"


def _complete(world: str, seeds: int, folder: Path, used: str) -> list[Statements]:
    flights = flights_in(folder / "flights")
    console, results = Console(), []
    with console.progress() as progress:
        for seed in range(1, seeds + 1):
            mission = Mission(world, EchoKind.IDEAL, seed)
            progress((seed - 1) / seeds, f"{mission}")
            results.append(_statements(mission, flights, folder / "consistency", used))
    return results


def _statements(mission: Mission, flights: FlightCache, folder: Path, used: str) -> Statements:
    """Return the mission's statements; what is missing is made and kept."""
    path = folder / f"{mission}_{used[:12]}.npz"
    if not path.exists():
        found = statements(flights.get(mission))
        folder.mkdir(parents=True, exist_ok=True)
        unfinished = path.with_suffix(".part")
        with unfinished.open("wb") as file:
            np.savez(file, **found)  # type: ignore[arg-type]
        unfinished.replace(path)
    with np.load(path) as kept:
        return {kind: kept[kind] for kind in kept.files}


if __name__ == "__main__":
    call(main)
