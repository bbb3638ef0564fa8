# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""What all nodes are: parameters, diagnostics, inputs, outputs, and three services."""

from collections.abc import Callable, Iterator, Sequence
from typing import Any

from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.node import Node
from rclpy.timer import Timer
from rclpy.waitable import Waitable

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.messages.topics import Topic
from msss_graphslam.ros.diagnostics import Diagnostics, Finding, Level
from msss_graphslam.ros.faults import Faults
from msss_graphslam.ros.inputs import Input, Rules
from msss_graphslam.ros.messages import message_class
from msss_graphslam.ros.outputs import Output
from msss_graphslam.ros.parameters import Parameters
from msss_graphslam.ros.running import leave, run

__all__ = ["SlamNode", "leave", "run"]

_TRIGGER = "std_srvs/srv/Trigger"
_SET_BOOL = "std_srvs/srv/SetBool"

# The middleware's events are looked for in one of so many pulses, ten a second.
_EVENT_PULSES = 5


class SlamNode(Node):
    """A node with the package's manners; no input makes it end.

    A derived class overrides ``on_reset``, ``on_save``, ``check_parameters``, ``on_parameters``
    and ``on_shutdown``.
    """

    _pulses = 0

    def __init__(
        self,
        name: str,
        groups: Sequence[str] = (),
        changeable: Sequence[str] = (),
        flat: Sequence[str] = (),
    ) -> None:
        super().__init__(name)
        self.paused = False
        self.diagnostics = Diagnostics(self)
        self.faults = Faults(self.diagnostics.refused, self.log_error)
        changed = self.faults.guarded(lambda now: self.on_parameters(now), "parameters")
        self.parameters = Parameters(
            self, groups, changeable, changed, flat, self.check_parameters
        )
        self._inputs: list[Input] = []
        self._outputs: list[Output] = []
        self._resets = 0
        self._frame_prefix = self.parameters.declare(
            "frame_prefix", "", "stands before the name of every frame that is published"
        )
        self.diagnostics.checks += [self._badly_configured, self._pausing]
        self.diagnostics.values["resets"] = lambda: self._resets
        self.create_service(message_class(_TRIGGER), "~/reset", self._reset)
        self.create_service(message_class(_TRIGGER), "~/save", self._save)
        self.create_service(message_class(_SET_BOOL), "~/pause", self._pause)

    @property
    def waitables(self) -> Iterator[Waitable]:
        """The middleware's events, now and then.

        rclpy takes everything that can happen in hand again for each message; events (lost,
        incompatible QoS) are most of it, and may wait.
        """
        yield from () if self._pulses % _EVENT_PULSES else super().waitables

    def pulse(self) -> None:
        """Note that another tenth of a second has gone by."""
        self._pulses += 1

    def log(self, text: str) -> None:
        """Tell what may interest a person."""
        Node.get_logger(self).info(text)

    def log_error(self, text: str) -> None:
        """Tell what a person has to know."""
        Node.get_logger(self).error(text)

    def frame(self, name: str) -> str:
        """Return the frame's name with the prefix."""
        return f"{self._frame_prefix}{name}"

    def listen(
        self,
        topic: Topic,
        decode: Callable[[Any], Any],
        take: Callable[[Any], None],
        *,
        ordered: bool = True,
        single: bool = False,
        required: bool = False,
        pausable: bool = True,
        shared: bool = False,
    ) -> Input:
        """Subscribe: messages are decoded to records, checked, and taken; see Rules."""
        rules = Rules(ordered, single, required, pausable, shared)
        subscribed = Input(
            self,
            topic,
            decode,
            take,
            rules,
            self.diagnostics,
            self.faults,
            lambda: self.paused,
        )
        self._inputs.append(subscribed)
        return subscribed

    def ignore(self, subscribed: Input) -> None:
        """Take back what ``listen`` returned."""
        self._inputs.remove(subscribed)
        subscribed.close()

    def offer(self, topic: Topic, depth: int | None = None) -> Output:
        """Advertise a topic, with ``depth`` messages kept."""
        output = Output(self, topic, depth, self.diagnostics)
        self._outputs.append(output)
        return output

    def every(self, period: float, work: Callable[[], object]) -> Timer:
        """Do the work each ``period`` seconds of wall time, whatever /clock says."""
        return self.create_timer(
            period,
            self.faults.guarded(work, "timer"),
            clock=Clock(clock_type=ClockType.STEADY_TIME),
        )

    def on_reset(self) -> None:
        """Start anew, as if nothing had come in yet."""

    def on_save(self) -> tuple[bool, str]:
        """Work off what is held and write what is to be written; say whether all is done."""
        return True, "nothing to save"

    def check_parameters(self, configuration: Configuration) -> None:
        """Raise UserError where changed parameters do not go together."""

    def on_parameters(self, configuration: Configuration) -> None:
        """Take over changed parameters."""

    def on_shutdown(self) -> None:
        """Do what is left before the end."""

    def _reset(self, _request: Any, response: Any) -> Any:
        for subscribed in self._inputs:
            subscribed.reset()
        for output in self._outputs:
            output.reset()
        self.diagnostics.clear()
        self._resets += 1
        return self._answered(response, self._started_anew)

    def _started_anew(self) -> tuple[bool, str]:
        self.on_reset()
        return True, "reset"

    def _save(self, _request: Any, response: Any) -> Any:
        return self._answered(response, self.on_save)

    def _pause(self, request: Any, response: Any) -> Any:
        self.paused = bool(request.data)
        return self._answered(response, lambda: (True, "paused" if self.paused else "running"))

    def _answered(self, response: Any, work: Callable[[], tuple[bool, str]]) -> Any:
        try:
            response.success, response.message = work()
        except Exception as error:
            self.faults.note(error, "service")
            response.success, response.message = False, f"{error!r}"
        return response

    def _badly_configured(self) -> Finding | None:
        problems = "; ".join(self.parameters.problems)
        return Finding(Level.ERROR, problems) if problems else None

    def _pausing(self) -> Finding | None:
        return Finding(Level.WARN, "paused") if self.paused else None
