# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Under which conditions ``full`` is judged, and the bars that it has to clear."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from benchmarks.alterations import Alteration
from benchmarks.missions import Changes, Mission
from benchmarks.trials import Trial
from msss_graphslam.simulation.echo_model import EchoKind
from msss_graphslam.simulation.inertial import NoiseLevel
from msss_graphslam.simulation.settings import Rotation

__all__ = ["DEMANDED", "UNTUNED", "Condition"]

IDEAL, REAL = EchoKind.IDEAL, EchoKind.REAL
REAL_FACTOR = 1.5
"""How much more the bars are with real echoes."""


@dataclass(frozen=True, slots=True)
class Condition:
    """A simulated situation and a configuration, whatever the seed.

    ``limits`` [m] are the bars by the name of the figure in Accuracy, on the mean over the seeds.
    """

    name: str
    world: str
    echo: EchoKind
    noise: NoiseLevel = NoiseLevel.PAPER
    dvl: bool = False
    sonar: Changes = ()
    values: Changes = ()
    alteration: Alteration = Alteration.NONE
    limits: Mapping[str, float] = field(default_factory=dict, hash=False)

    def trial(self, seed: int) -> Trial:
        """Return the run of ``full`` with a seed."""
        mission = Mission(self.world, self.echo, seed, self.noise, self.dvl, self.sonar)
        return Trial(mission, values=self.values, alteration=self.alteration)

    def trials(self, seeds: int) -> list[Trial]:
        """Return the runs with the seeds from 1 on."""
        return [self.trial(seed) for seed in range(1, seeds + 1)]


def _head(**settings: Any) -> Changes:
    return tuple(settings.items())


def _with_both_echoes(world: str, online: float | None, **limits: float) -> Iterable[Condition]:
    for echo in (IDEAL, REAL):
        factor = 1.0 if echo is IDEAL else REAL_FACTOR
        bars = {name: factor * limit for name, limit in limits.items()}
        if online is not None:
            bars["online"] = online
        yield Condition(f"{world}, {echo} echoes", world, echo, limits=bars)


_SHADOW = _head(hull_sector=np.radians(162.0), hull_shadow=np.radians(162.0))

DEMANDED = (
    *_with_both_echoes("paper", 0.35, anchored=0.15, aligned=0.03),
    *_with_both_echoes("pond", None, anchored=0.12, aligned=0.03, gap=0.12),
    *_with_both_echoes("marina", None, anchored=0.30, aligned=0.10),
    *_with_both_echoes("cave", None, anchored=0.40, aligned=0.08),
    Condition(
        "paper, noise `high`",
        "paper",
        IDEAL,
        NoiseLevel.HIGH,
        limits={"anchored": 0.80, "aligned": 0.10},
    ),
    Condition(
        "pond, hull shadows 162 deg",
        "pond",
        REAL,
        sonar=_SHADOW,
        limits={"anchored": 1.00, "aligned": 0.40},
    ),
    Condition("paper, with DVL", "paper", IDEAL, dvl=True),
    Condition("pond, with DVL", "pond", IDEAL, dvl=True),
)
"""What issue 5 sets bars for."""


def _speed(assumed: float) -> Changes:
    return (("dead_reckoning.surge_speed", assumed),)


def _step(degrees: float) -> Changes:
    return _head(step=np.radians(degrees))


def _range(metres: float) -> Changes:
    """Return a range, and a time for a beam in which echoes from there come back."""
    return _head(maximum_range=metres, beam_period=max(0.0427, 2.0 * metres / 1500.0 + 0.011))


def _sector(degrees: float) -> Changes:
    return _head(sector=np.radians(degrees))


def _untuned(world: str, echo: EchoKind, *changes: tuple[str, dict[str, Any]]) -> list[Condition]:
    return [Condition(name, world, echo, **change) for name, change in changes]


_NO_IMU = {"alteration": Alteration.NO_IMU}
_MISALIGNED = {"sonar": _head(mount_yaw=np.radians(2.0))}
_SOUND = {"alteration": Alteration.SOUND_SPEED}

UNTUNED = (
    *_untuned(
        "pond",
        REAL,
        ("as it is: 1.8 deg, 20 m, 350 bins, clockwise", {}),
        *(
            (f"assumed speed {speed:g} m/s", {"values": _speed(speed)})
            for speed in (0.0, 0.05, 0.15, 0.2)
        ),
        *((f"steps of {step:g} deg", {"sonar": _step(step)}) for step in (0.9, 3.6)),
        *((f"range {metres:g} m", {"sonar": _range(metres)}) for metres in (10.0, 50.0)),
        *((f"{bins} bins", {"sonar": _head(bins=bins)}) for bins in (100, 200, 800)),
        ("4 bits a bin", {"alteration": Alteration.FOUR_BITS}),
        *(
            (f"sector of {sector:g} deg", {"sonar": _sector(sector)})
            for sector in (120.0, 180.0, 270.0)
        ),
        ("counter-clockwise", {"sonar": _head(rotation=Rotation.COUNTER_CLOCKWISE)}),
        ("no IMU", _NO_IMU),
        ("head misaligned by 2 deg", _MISALIGNED),
        ("sound 1 % faster than assumed", _SOUND),
    ),
    *_untuned(
        "paper",
        IDEAL,
        ("as it is: 1.5 deg, 24 m, 400 bins, counter-clockwise", {}),
        *((f"assumed speed {speed:g} m/s", {"values": _speed(speed)}) for speed in (0.0, 0.2)),
        *((f"steps of {step:g} deg", {"sonar": _step(step)}) for step in (0.9, 3.6)),
        *((f"range {metres:g} m", {"sonar": _range(metres)}) for metres in (10.0, 50.0)),
        *((f"{bins} bins", {"sonar": _head(bins=bins)}) for bins in (100, 800)),
        ("sector of 180 deg", {"sonar": _sector(180.0)}),
        ("clockwise", {"sonar": _head(rotation=Rotation.CLOCKWISE)}),
        ("no IMU", _NO_IMU),
        ("head misaligned by 2 deg", _MISALIGNED),
        ("head misaligned by 2 deg, with DVL", {**_MISALIGNED, "dvl": True}),
        ("sound 1 % faster than assumed", _SOUND),
        ("sound 1 % faster than assumed, with DVL", {**_SOUND, "dvl": True}),
    ),
    *_untuned(
        "marina",
        REAL,
        ("as it is: 1.8 deg, 50 m, 500 bins, counter-clockwise", {}),
        ("range 75 m", {"sonar": _range(75.0)}),
        ("range 20 m", {"sonar": _range(20.0)}),
    ),
    *_untuned(
        "cave",
        REAL,
        ("as it is: 1.8 deg, 20 m, 400 bins, counter-clockwise", {}),
        ("assumed speed 0 m/s", {"values": _speed(0.0)}),
        ("range 10 m", {"sonar": _range(10.0)}),
    ),
)
"""The same configuration under other settings, by world."""
