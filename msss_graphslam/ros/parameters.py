# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The configuration as parameters of a node.

A value that cannot be used never ends a node: at the start the default stays in its place and the
problem is told, later the change is refused with the reason.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from math import isfinite
from typing import Any

from rclpy.node import Node
from rclpy.parameter import Parameter

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.config.fields import ParameterError, ParameterInfo
from msss_graphslam.errors import UserError
from msss_graphslam.ros.messages import make

__all__ = ["Parameters"]

_DESCRIPTOR = "rcl_interfaces/msg/ParameterDescriptor"
_FLOAT_RANGE = "rcl_interfaces/msg/FloatingPointRange"
_INTEGER_RANGE = "rcl_interfaces/msg/IntegerRange"
_RESULT = "rcl_interfaces/msg/SetParametersResult"


class Parameters:
    """Declares groups of the Configuration on a node and keeps them valid.

    ``problems`` are the values of the start that could not be used, in words. A change of a group
    in ``changeable`` is handed to ``on_change`` as a whole Configuration; the other groups are
    read-only. Parameters of a group in ``flat`` are declared without the group's name; at first
    they take the value that a file has under the full name, unless the short one is given, too.
    ``fits`` raises UserError for a change whose values, each admitted, do not go together.
    """

    def __init__(
        self,
        node: Node,
        groups: Sequence[str] = (),
        changeable: Sequence[str] = (),
        on_change: Callable[[Configuration], None] | None = None,
        flat: Sequence[str] = (),
        fits: Callable[[Configuration], object] | None = None,
    ) -> None:
        self.problems: list[str] = []
        self._node = node
        self._on_change = on_change
        self._fits = fits
        self._infos: dict[str, ParameterInfo] = {}
        self._full_names: dict[str, str] = {}
        self._values: dict[str, Any] = {}
        for info in Configuration.parameters():
            group = info.name.partition(".")[0]
            if group in groups:
                self._configured(info, group in flat, read_only=group not in changeable)
        self._refuse_unknown(groups)
        node.add_pre_set_parameters_callback(self._in_kind)
        node.add_on_set_parameters_callback(self._checked)
        node.add_post_set_parameters_callback(self._changed)

    @property
    def configuration(self) -> Configuration:
        """The configuration as it stands; groups that were not declared have their defaults."""
        return Configuration().with_values(self._values)

    def declare(
        self,
        name: str,
        default: Any,
        description: str,
        *,
        minimum: float | None = None,
        maximum: float | None = None,
        choices: Sequence[str] = (),
    ) -> Any:
        """Declare a read-only parameter of the node's own and return its value."""
        info = ParameterInfo(
            name=name,
            kind=type(default),
            default=default,
            meaning=description,
            unit="",
            minimum=minimum,
            maximum=maximum,
            choices=tuple(choices),
            source="",
        )
        return self._declared(info, read_only=True)

    def _configured(self, info: ParameterInfo, is_flat: bool, *, read_only: bool) -> None:
        full = info.name
        if is_flat:
            info = replace(info, name=full.partition(".")[2])
        value = self._declared(info, read_only=read_only, instead=full)
        try:
            Configuration().with_values({**self._values, full: value})
        except UserError as error:
            self._tell(f"{error}; {info.default!r} is used")
            return
        self._full_names[info.name] = full
        self._values[full] = value

    def _declared(self, info: ParameterInfo, *, read_only: bool, instead: str = "") -> Any:
        value = self._at_start(info, instead)
        self._infos[info.name] = info
        self._node.declare_parameter(
            info.name, value, _descriptor(info, read_only=read_only), ignore_override=True
        )
        return value

    def _at_start(self, info: ParameterInfo, instead: str) -> Any:
        """Return the value that was given at the start if it can be used, else the default."""
        overrides = _overrides(self._node)
        given = next((name for name in (info.name, instead) if name in overrides), None)
        if given is None:
            return info.default
        try:
            return _validated(info, overrides[given].value)
        except UserError as error:
            self._tell(f"{error}; {info.default!r} is used")
            return info.default

    def _refuse_unknown(self, groups: Sequence[str]) -> None:
        """Tell of names that look like ours and are none: a slip of the pen changes nothing."""
        known = {*self._infos, *self._full_names.values()}
        for name in _overrides(self._node):
            if name.partition(".")[0] in groups and name not in known:
                try:
                    Configuration().with_values({name: 0})
                except UserError as error:
                    self._tell(str(error))

    def _tell(self, problem: str) -> None:
        self.problems.append(problem)
        self._node.get_logger().error(problem)

    def _in_kind(self, parameters: list[Parameter]) -> list[Parameter]:
        """Read ``20`` as 20.0 where a float is meant."""
        return [self._as_declared(parameter) for parameter in parameters]

    def _as_declared(self, parameter: Parameter) -> Parameter:
        info = self._infos.get(parameter.name)
        if info is None or info.kind is not float or parameter.type_ != Parameter.Type.INTEGER:
            return parameter
        return Parameter(parameter.name, value=float(parameter.value))

    def _checked(self, parameters: list[Parameter]) -> Any:
        try:
            changes = self._validated_changes(parameters)
            configuration = Configuration().with_values({**self._values, **changes})
            if changes and self._fits is not None:
                self._fits(configuration)
        except UserError as error:
            return make(_RESULT, successful=False, reason=str(error))
        return make(_RESULT, successful=True)

    def _changed(self, parameters: list[Parameter]) -> None:
        changes = self._validated_changes(parameters)
        self._values.update(changes)
        if changes and self._on_change is not None:
            self._on_change(self.configuration)

    def _validated_changes(self, parameters: Iterable[Parameter]) -> dict[str, Any]:
        return {
            self._full_names[parameter.name]: _validated(
                self._infos[parameter.name], parameter.value
            )
            for parameter in parameters
            if parameter.name in self._full_names
        }


def _overrides(node: Node) -> dict[str, Parameter]:
    # rclpy has no public way to look at a value before it is declared, and a declaration with one
    # that does not fit raises.
    overrides: dict[str, Parameter] = node._parameter_overrides
    return overrides


def _validated(info: ParameterInfo, value: Any) -> Any:
    if isinstance(value, str) and info.kind is not str:
        raise ParameterError(f"{info.name} = {value!r}: must be of type {info.kind.__name__}")
    value = info.validate(value)
    if isinstance(value, float) and not isfinite(value):
        raise ParameterError(f"{info.name} = {value!r}: must be finite")
    return value


def _descriptor(info: ParameterInfo, *, read_only: bool) -> Any:
    unit = f" [{info.unit}]" if info.unit else ""
    source = f" ({info.source})" if info.source else ""
    descriptor = make(
        _DESCRIPTOR, description=f"{info.meaning}{unit}{source}", read_only=read_only
    )
    if info.minimum is None or info.maximum is None:
        descriptor.additional_constraints = info.range_text
    elif info.kind is float:
        descriptor.floating_point_range = [
            make(_FLOAT_RANGE, from_value=float(info.minimum), to_value=float(info.maximum))
        ]
    else:
        descriptor.integer_range = [
            make(_INTEGER_RANGE, from_value=int(info.minimum), to_value=int(info.maximum))
        ]
    return descriptor
