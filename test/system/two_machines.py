# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Two network namespaces joined by a cable that can lose packets and be pulled out."""

import os
import shutil
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager

__all__ = ["Cable", "cable", "why_not"]

_TOOLS = ("ip", "nft")
_VEHICLE, _TOPSIDE = "10.77.0.1/24", "10.77.0.2/24"
_LOSS = "numgen random mod 100 <"

ENVIRONMENT = {
    "ROS_AUTOMATIC_DISCOVERY_RANGE": "SUBNET",
    # Two machines share no memory; the namespaces of one would.
    "FASTDDS_BUILTIN_TRANSPORTS": "UDPv4",
}


def why_not() -> str:
    """Return why this machine cannot make network namespaces, '' if it can."""
    if os.geteuid() != 0:
        return "network namespaces need root"
    missing = [tool for tool in _TOOLS if shutil.which(tool) is None]
    if missing:
        return f"not installed: {', '.join(missing)} (Debian: iproute2, nftables)"
    name = f"msss_{os.getpid()}_try"
    if _try(["ip", "netns", "add", name]):
        return "network namespaces are not permitted here"
    problem = _try(["ip", "netns", "exec", name, "nft", "-f", "-"], _rules(1))
    _try(["ip", "netns", "delete", name])
    return f"nftables cannot drop at random here: {problem}" if problem else ""


class Cable:
    """The link between the two machines, each by the command that runs something on it."""

    def __init__(self, vehicle: str, topside: str) -> None:
        self.vehicle = ["ip", "netns", "exec", vehicle]
        self.topside = ["ip", "netns", "exec", topside]

    def lose(self, percent: int) -> None:
        """Lose so many of the packets from now on, either way."""
        for machine in (self.vehicle, self.topside):
            _run([*machine, "nft", "-f", "-"], _rules(percent))

    def lost(self) -> int:
        """Return how many packets were lost."""
        listed = [_run([*machine, "nft", "list", "ruleset"]) for machine in self._machines]
        words = " ".join(listed).split()
        return sum(int(words[i + 1]) for i, word in enumerate(words) if word == "packets")

    def pull(self) -> None:
        """Cut the connection."""
        _run([*self.vehicle, "ip", "link", "set", "cable", "down"])

    def plug_in(self) -> None:
        """Connect again."""
        _run([*self.vehicle, "ip", "link", "set", "cable", "up"])
        _route(self.vehicle)

    @property
    def _machines(self) -> list[list[str]]:
        return [self.vehicle, self.topside]


@contextmanager
def cable() -> Iterator[Cable]:
    """Give two machines and the cable between them."""
    names = [f"msss_{os.getpid()}_{end}" for end in ("vehicle", "topside")]
    try:
        for name in names:
            _run(["ip", "netns", "add", name])
        peer = ["peer", "name", "cable", "netns", names[1]]
        _run(["ip", "link", "add", "cable", "netns", names[0], "type", "veth", *peer])
        made = Cable(*names)
        for machine, address in ((made.vehicle, _VEHICLE), (made.topside, _TOPSIDE)):
            _run([*machine, "ip", "address", "add", address, "dev", "cable"])
            for device in ("lo", "cable"):
                _run([*machine, "ip", "link", "set", device, "up"])
            _route(machine)
        yield made
    finally:
        for name in names:
            _try(["ip", "netns", "delete", name])


def _route(machine: list[str]) -> None:
    """Multicast, by which the nodes find each other, goes through the cable."""
    _run([*machine, "ip", "route", "replace", "224.0.0.0/4", "dev", "cable"])


def _rules(percent: int) -> str:
    return f"""
        add table ip loss
        delete table ip loss
        table ip loss {{
            chain in {{
                type filter hook input priority 0;
                iifname "cable" {_LOSS} {percent} counter drop
            }}
        }}
    """


def _run(command: list[str], text: str = "") -> str:
    done = subprocess.run(command, input=text, capture_output=True, text=True, check=False)
    assert done.returncode == 0, f"{' '.join(command)}: {done.stderr}"
    return done.stdout


def _try(command: list[str], text: str = "") -> str:
    """Return what went wrong, '' if nothing did."""
    done = subprocess.run(command, input=text, capture_output=True, text=True, check=False)
    return (done.stderr.strip() or "failed") if done.returncode else ""
