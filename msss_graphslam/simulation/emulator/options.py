# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The command line of ``micron_emulator``."""

from argparse import ArgumentParser, ArgumentTypeError, Namespace, _ArgumentGroup
from collections.abc import Callable
from pathlib import Path

from msss_graphslam.errors import UserError
from msss_graphslam.simulation.echo_model import EchoKind
from msss_graphslam.simulation.emulator.faults import Faults, Span
from msss_graphslam.simulation.emulator.ports import Port, PseudoTerminal, TcpPort
from msss_graphslam.simulation.emulator.scanner import Nature
from msss_graphslam.simulation.worlds import WORLD_NAMES

__all__ = ["faults_of", "nature_of", "parser", "port_of"]

_HIGHEST_PORT = 65535


def parser() -> ArgumentParser:
    """Return the parser."""
    made = ArgumentParser(
        prog="micron_emulator",
        description="A Tritech Micron's head that looks into a simulated world, for a driver to"
        " practise with: at a pseudo-terminal or a TCP port, with the real timing, and with faults"
        " to order. Times are seconds after the start.",
    )
    port = made.add_mutually_exclusive_group(required=True)
    port.add_argument("--pty", type=Path, metavar="PATH", help="link to make to a pseudo-terminal")
    port.add_argument(
        "--tcp", type=_port_number, metavar="PORT", help="port of this machine; 0: any free one"
    )
    _add_head(made)
    _add_faults(made)
    return made


def port_of(arguments: Namespace) -> Port:
    """Return the port that was asked for, not plugged yet."""
    return PseudoTerminal(arguments.pty) if arguments.pty else TcpPort(arguments.tcp)


def nature_of(arguments: Namespace) -> Nature:
    """Return the kind of head that was asked for."""
    return Nature(
        seaking=arguments.head_type == "seaking",
        full_duplex=arguments.duplex == "full",
        baudrate=arguments.baudrate,
        fewer_bins=arguments.fewer_bins,
        inverted=arguments.inverted,
    )


def faults_of(arguments: Namespace) -> Faults:
    """Return the faults that were ordered; raises UserError where one makes no sense."""
    return Faults(
        garbage=arguments.garbage,
        lost=arguments.lost,
        flipped=arguments.flipped,
        split=arguments.split,
        resets=tuple(arguments.reset),
        motor_errors=tuple(arguments.motor_error),
        silences=tuple(arguments.silence),
        unplugged=tuple(arguments.unplug),
    )


def _add_head(made: ArgumentParser) -> None:
    head = made.add_argument_group("head and world")
    head.add_argument("--world", choices=WORLD_NAMES, default="pond", help="default pond")
    head.add_argument("--seed", type=_count, default=1, metavar="N", help="default 1")
    head.add_argument("--echo", type=EchoKind, choices=list(EchoKind), default=EchoKind.REAL)
    head.add_argument("--head-type", choices=("dst", "seaking"), default="dst")
    head.add_argument(
        "--duplex", choices=("full", "half"), default="full", help="RS232, or two-wire RS485"
    )
    head.add_argument("--baudrate", type=_positive, default=115200, metavar="BD")
    head.add_argument("--inverted", action="store_true", help="the head hangs upside down")
    head.add_argument(
        "--fewer-bins", type=_count, default=0, metavar="N", help="bins short of what is asked for"
    )


def _add_faults(made: ArgumentParser) -> None:
    faults = made.add_argument_group("faults")
    for name, meaning in (
        ("--garbage", "packets with garbage before them"),
        ("--lost", "bytes lost, both ways"),
        ("--flipped", "bytes with a bit flipped, both ways"),
    ):
        faults.add_argument(name, type=float, default=0.0, metavar="SHARE", help=meaning)
    faults.add_argument(
        "--split", type=_count, default=0, metavar="N", help="pieces of up to N bytes"
    )
    _add_times(
        faults,
        _time,
        "T",
        {"reset": "the head starts anew", "motor-error": "the motor loses its position"},
    )
    _add_times(
        faults,
        _span,
        "T:DURATION",
        {"silence": "nothing comes from the head", "unplug": "the port is gone"},
    )


def _add_times(
    group: _ArgumentGroup, kind: Callable[[str], object], form: str, faults: dict[str, str]
) -> None:
    for name, meaning in faults.items():
        group.add_argument(
            f"--{name}",
            type=kind,
            action="append",
            default=[],
            metavar=form,
            help=f"{meaning}; may be given again",
        )


def _count(text: str) -> int:
    if not text.isdecimal():
        raise ArgumentTypeError(f"{text!r} must be a whole number from 0 on")
    return int(text)


def _positive(text: str) -> int:
    if not (number := _count(text)):
        raise ArgumentTypeError(f"{text!r} must be positive")
    return number


def _port_number(text: str) -> int:
    if (number := _count(text)) > _HIGHEST_PORT:
        raise ArgumentTypeError(f"{text!r} is above {_HIGHEST_PORT}")
    return number


def _time(text: str) -> float:
    return _span(f"{text}:1").start


def _span(text: str) -> Span:
    start, _, duration = text.partition(":")
    try:
        return Span(float(start), float(duration))
    except ValueError:
        raise ArgumentTypeError(f"{text!r} must be seconds, T or T:DURATION") from None
    except UserError as error:
        raise ArgumentTypeError(str(error)) from None
