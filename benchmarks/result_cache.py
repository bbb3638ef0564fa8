# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Results of single runs, kept until the package changes."""

import hashlib
import json
from collections.abc import Iterable
from dataclasses import asdict, dataclass
from pathlib import Path

import msss_graphslam
from benchmarks import alterations, flights, front_memory, jumps, missions, neutral, parts, trials
from benchmarks.missions import Accuracy
from benchmarks.trials import Trial

__all__ = ["ResultCache", "fingerprint", "simulation_sources", "sources"]

PACKAGE = Path(msss_graphslam.__file__).parent
SIMULATED = ("simulation",)
ESTIMATED = ("config", "core", "evaluation", "messages", "simulation")
"""Folders of the package that a run's figures depend on."""
WITHOUT_EFFECT = {"figures", "emulator"}
"""Folders in these that they do not depend on."""


@dataclass(frozen=True, slots=True)
class ResultCache:
    """A file for each run in ``folder``; one made by other sources counts as missing."""

    folder: Path
    fingerprint: str

    def load(self, trial: Trial) -> Accuracy | None:
        """Return the run's result, or None where it has to be made; an outdated one is deleted."""
        path = self._path(trial)
        if not path.exists():
            return None
        kept = json.loads(path.read_text(encoding="utf-8"))
        if kept["sources"] != self.fingerprint:
            path.unlink()
            return None
        return Accuracy(**kept["accuracy"])

    def store(self, trial: Trial, accuracy: Accuracy) -> None:
        """Keep the run's result; the file is written whole or not at all."""
        path = self._path(trial)
        text = json.dumps({"sources": self.fingerprint, "accuracy": asdict(accuracy)}, indent=2)
        unfinished = path.with_suffix(".part")
        unfinished.write_text(f"{text}\n", encoding="utf-8")
        unfinished.replace(path)

    def _path(self, trial: Trial) -> Path:
        return self.folder / f"{trial}.json"


def sources() -> list[Path]:
    """Return the files that a run's result depends on, sorted."""
    makers = (alterations, flights, front_memory, jumps, missions, neutral, parts, trials)
    return _sources(ESTIMATED, [Path(module.__file__ or "") for module in makers])


def simulation_sources() -> list[Path]:
    """Return the files that a simulated mission depends on, sorted."""
    return _sources(SIMULATED, [Path(flights.__file__)])


def fingerprint(paths: Iterable[Path]) -> str:
    """Return a checksum of the files' names and contents."""
    checksum = hashlib.sha256()
    for path in paths:
        checksum.update(f"{path.name}\0".encode())
        checksum.update(path.read_bytes())
        checksum.update(b"\0")
    return checksum.hexdigest()


def _sources(folders: Iterable[str], others: Iterable[Path]) -> list[Path]:
    used = [
        path
        for folder in folders
        for path in (PACKAGE / folder).rglob("*.py")
        if WITHOUT_EFFECT.isdisjoint(path.relative_to(PACKAGE).parts)
    ]
    return sorted([*used, *others])
