# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The stages of a conversation with the head: what is sent, how long it is waited for."""

from dataclasses import dataclass
from enum import StrEnum

from msss_graphslam.micron.packets import (
    HeadCommand,
    Reboot,
    SendData,
    SendUserData,
    SendVersion,
)
from msss_graphslam.micron.settings import HeadSettings

__all__ = ["HeadState", "Stage", "stage_of"]


class HeadState(StrEnum):
    """How far the conversation has come."""

    CLOSED = "closed"
    RESUMING = "resuming"
    REBOOTING = "rebooting"
    CENTRING = "centring"
    IDENTIFYING = "identifying"
    ASKING_DUPLEX = "asking for the kind of line"
    CONFIGURING = "configuring"
    SCANNING = "scanning"


@dataclass(frozen=True, slots=True)
class Stage:
    """``request`` is sent ``tries`` times, ``patience`` [s] apart; then comes ``otherwise``."""

    request: Reboot | SendVersion | SendUserData | HeadCommand | SendData | None
    patience: float
    tries: int
    otherwise: HeadState


_FIXED = {
    # A head is silent for 2.5 s after mtReBoot, then says once a second that it is there.
    HeadState.REBOOTING: Stage(Reboot(), 10.0, 1, HeadState.REBOOTING),
    HeadState.CENTRING: Stage(None, 30.0, 1, HeadState.REBOOTING),
    HeadState.IDENTIFYING: Stage(SendVersion(), 1.0, 3, HeadState.REBOOTING),
    HeadState.ASKING_DUPLEX: Stage(SendUserData(), 1.0, 2, HeadState.CONFIGURING),
}


def stage_of(state: HeadState, settings: HeadSettings) -> Stage:
    """Return what is done in a state other than closed."""
    match state:
        case HeadState.RESUMING:
            return Stage(SendData(), settings.reply_timeout, 2, HeadState.REBOOTING)
        case HeadState.CONFIGURING:
            # The head says so when it is ready; if that is lost, it answers requests all the same.
            return Stage(settings.command, 1.0, 1, HeadState.SCANNING)
        case HeadState.SCANNING:
            return Stage(SendData(), settings.reply_timeout, 5, HeadState.CONFIGURING)
        case _:
            return _FIXED[state]
