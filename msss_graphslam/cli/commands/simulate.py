# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""``msss simulate``: a bag and its truth from a simulated world."""

from argparse import ArgumentParser, ArgumentTypeError, Namespace

from msss_graphslam.cli.console import Console
from msss_graphslam.cli.exit_codes import ExitCode
from msss_graphslam.cli.options import add_output
from msss_graphslam.simulation.echo_model import EchoKind
from msss_graphslam.simulation.inertial import NoiseLevel
from msss_graphslam.simulation.worlds import WORLD_NAMES, world_named

__all__ = ["SUMMARY", "add_arguments", "execute"]

SUMMARY = "make a bag with its ground truth from a simulated world"


def add_arguments(parser: ArgumentParser) -> None:
    """Add the command's arguments."""
    parser.add_argument("world", choices=WORLD_NAMES)
    parser.add_argument(
        "--seed", type=_seed, required=True, metavar="N", help="the same seed, the same bag"
    )
    add_output(parser, "the bag")
    parser.add_argument(
        "--noise",
        type=NoiseLevel,
        choices=list(NoiseLevel),
        default=NoiseLevel.PAPER,
        help="how far motion and attitude are off (default paper)",
    )
    parser.add_argument(
        "--echo",
        type=EchoKind,
        choices=list(EchoKind),
        default=EchoKind.REAL,
        help="echoes as a real head sends them, or a clean pulse and noise (default real)",
    )
    parser.add_argument(
        "--raw",
        action="store_true",
        help="the bytes of the head's port (sonar/raw) in place of the beams (sonar/ping)",
    )


def execute(arguments: Namespace, console: Console) -> ExitCode:
    """Simulate and write the bag."""
    from msss_graphslam.simulation.recording import simulate

    with console.progress() as progress:
        written = simulate(
            world_named(arguments.world),
            arguments.seed,
            arguments.out,
            noise=arguments.noise,
            echo=arguments.echo,
            raw=arguments.raw,
            progress=lambda fraction: progress(fraction, f"simulating {arguments.world}"),
        )
    data = {"bag": str(written.bag), "ground_truth": str(written.ground_truth)}
    console.result(data, lambda: console.table(("", "path"), list(data.items())))
    return ExitCode.CLEAN


def _seed(text: str) -> int:
    if not text.isdecimal():
        raise ArgumentTypeError(f"{text!r} must be a whole number from 0 on")
    return int(text)
