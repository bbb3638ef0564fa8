# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""A whole run of the nodes: what must be there is looked for first, then a session."""

import shlex
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory

from msss_graphslam.errors import UserError
from msss_graphslam.live.command_table import Setup, command_table, saving_order
from msss_graphslam.live.conclusion import concluding_in
from msss_graphslam.live.replayed import configured_for, needs_driver, truth_of
from msss_graphslam.live.session import Outcome, Progress, run_session
from msss_graphslam.live.supervisor import Say
from msss_graphslam.nodes.names import REPLAY, SLAM_NODES
from msss_graphslam.results.directory import ResultDirectory

__all__ = ["run"]

_LOGS = "log"
_SUMMARY = "summary.json"
_ABSENT = "was not found at the end, its last data may be missing"


def run(setup: Setup, say: Say, progress: Progress) -> Outcome:
    """Run every node as a process of its own, and have the results written.

    Raises UserError where that cannot be, before anything is started if it can be known then,
    where no results were written, or where a second signal has broken that off.
    """
    setup = _checked(setup)
    directory = ResultDirectory.create(setup.output)
    before = _files(directory.path)
    try:
        outcome = _session(setup, directory.path / _LOGS, say, progress)
    except KeyboardInterrupt as interrupt:
        raise UserError(_lost(setup, _files(directory.path) - before)) from interrupt
    if not any(path.name == _SUMMARY for path, _ in _files(directory.path) - before):
        raise UserError(f"{setup.output}: nothing written, {_reason(outcome)}")
    absent = {name: _ABSENT for name in saving_order(setup) if name not in outcome.answers}
    return replace(outcome, failed=absent | outcome.failed)


def _session(setup: Setup, logs: Path, say: Say, progress: Progress) -> Outcome:
    with TemporaryDirectory(prefix="msss_live_") as folder:
        return run_session(
            command_table(setup, Path(folder)),
            logs,
            saving=saving_order(setup),
            until=REPLAY if setup.replay is not None else None,
            concluding=concluding_in(setup.namespace),
            say=say,
            progress=progress,
        )


def _checked(setup: Setup) -> Setup:
    """Return the setup as the replayed bag completes it; UserError for what cannot work."""
    if find_spec("rclpy") is None:
        raise UserError("rclpy is missing: source ROS 2 Jazzy, or use the .venv of `make setup`")
    if setup.record is not None and setup.record.exists():
        raise UserError(f"{setup.record}: exists already; nothing is recorded over it")
    if setup.replay is None:
        return setup
    truth_of(setup.replay)  # Read now, so that nobody waits for it at the end.
    return replace(
        setup,
        configuration=configured_for(setup.replay, setup.configuration),
        driver=needs_driver(setup.replay),
    )


def _reason(outcome: Outcome) -> str:
    """Return why there are no results: who failed first, or what was said in place of saving."""
    for name, reason in outcome.failed.items():
        return f"{name}: {reason}"
    writer = SLAM_NODES[-1]
    return f"{writer}: {outcome.answers.get(writer, 'was not found')}"


def _lost(setup: Setup, written: set[tuple[Path, int]]) -> str:
    """Return what there is not where saving was broken off, and whether it can be made again."""
    names = sorted(path.name for path, _ in written)
    lost = f"all but {', '.join(names)} is lost" if names else "nothing was written"
    bag = setup.record or setup.replay
    command = shlex.join(["msss", "run", str(bag), "--out", str(setup.output)])
    again = f"make it anew by `{command}`" if bag else "no bag has it"
    return f"{setup.output}: ended by the second signal, {lost}; {again}"


def _files(folder: Path) -> set[tuple[Path, int]]:
    """Return the files with the times [ns] of their last change, those being written left out."""
    found = (path for path in folder.iterdir() if path.is_file() and path.name[0] != ".")
    return {(path, path.stat().st_mtime_ns) for path in found}
