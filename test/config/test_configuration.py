# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Every parameter's range from both sides, text as people type it, and unknown names."""

import math
from dataclasses import FrozenInstanceError

import pytest

from msss_graphslam.config.configuration import Configuration
from msss_graphslam.config.fields import ParameterError, ParameterInfo, check
from msss_graphslam.config.groups import Sonar

PARAMETERS = Configuration.parameters()
NUMBERS = [info for info in PARAMETERS if info.kind in (int, float)]
LIMITS = [
    pytest.param(info, limit, outwards, id=f"{info.name}-{word}")
    for info in NUMBERS
    for word, limit, outwards in (
        ("minimum", info.minimum, -math.inf),
        ("maximum", info.maximum, math.inf),
    )
    if limit is not None
]


def names(info: ParameterInfo) -> str:
    return info.name


@pytest.mark.parametrize(("info", "limit", "outwards"), LIMITS)
def test_the_limit_itself_is_admitted(info: ParameterInfo, limit: float, outwards: float) -> None:
    del outwards
    assert info.validate(info.kind(limit)) == limit


@pytest.mark.parametrize(("info", "limit", "outwards"), LIMITS)
def test_the_next_value_beyond_the_limit_is_refused(
    info: ParameterInfo, limit: float, outwards: float
) -> None:
    step = int(math.copysign(1, outwards))
    beyond = math.nextafter(limit, outwards) if info.kind is float else int(limit) + step
    with pytest.raises(ParameterError, match=info.name):
        info.validate(beyond)


@pytest.mark.parametrize("info", PARAMETERS, ids=names)
def test_every_default_is_admitted(info: ParameterInfo) -> None:
    assert info.validate(info.default) == info.default


@pytest.mark.parametrize("info", PARAMETERS, ids=names)
def test_every_parameter_says_what_it_means(info: ParameterInfo) -> None:
    assert len(info.meaning.split()) >= 3


@pytest.mark.parametrize("info", PARAMETERS, ids=names)
def test_a_default_typed_as_text_gives_itself(info: ParameterInfo) -> None:
    changed = Configuration().with_values({info.name: str(info.default)})
    assert changed == Configuration()


@pytest.mark.parametrize("info", NUMBERS, ids=names)
@pytest.mark.parametrize("text", ["", "fast", "1 m", "0x10", "[1.0]"])
def test_text_that_is_no_number_is_refused(info: ParameterInfo, text: str) -> None:
    with pytest.raises(ParameterError, match=f"must be of type {info.kind.__name__}"):
        info.validate(text)


@pytest.mark.parametrize("info", [info for info in NUMBERS if info.kind is float], ids=names)
def test_nan_is_refused(info: ParameterInfo) -> None:
    with pytest.raises(ParameterError):
        info.validate(math.nan)


def test_a_changed_copy_leaves_the_original_alone() -> None:
    original = Configuration()
    changed = original.with_values({"dead_reckoning.surge_speed": "0.25"})
    assert changed.dead_reckoning.surge_speed == 0.25
    assert original == Configuration()
    assert changed.sonar == original.sonar


def test_values_are_frozen() -> None:
    with pytest.raises(FrozenInstanceError):
        Configuration().sonar.mount_x = 1.0  # type: ignore[misc]


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("sonar.mont_x", "unknown parameter 'sonar.mont_x'; did you mean 'sonar.mount_x'?"),
        ("mount_x", "unknown parameter 'mount_x'"),
        ("sonar", "unknown parameter 'sonar'"),
        ("", "unknown parameter ''"),
        ("sonar.mount_x.y", "unknown parameter 'sonar.mount_x.y'"),
    ],
)
def test_an_unknown_name_is_refused_with_the_nearest_one(name: str, message: str) -> None:
    with pytest.raises(ParameterError) as caught:
        Configuration().with_values({name: 1.0})
    assert str(caught.value).startswith(message)


@pytest.mark.parametrize("value", [True, [1.0], None, {}])
def test_a_value_of_another_type_is_refused(value: object) -> None:
    with pytest.raises(ParameterError, match="must be of type float"):
        Configuration().with_values({"sonar.mount_x": value})


def test_a_whole_number_does_for_a_float() -> None:
    assert Configuration().with_values({"sonar.mount_x": 1}).sonar.mount_x == 1.0


def test_a_choice_that_is_not_one_is_refused_with_the_choices() -> None:
    with pytest.raises(ParameterError, match="must be one of db80, linear"):
        Configuration().with_values({"sonar.intensity_scale": "log"})


@pytest.mark.parametrize(("text", "value"), [("true", True), ("False", False), ("TRUE", True)])
def test_truth_values_are_words(text: str, value: bool) -> None:
    changed = Configuration().with_values({"sensors.gauge_pressure": text})
    assert changed.sensors.gauge_pressure is value


@pytest.mark.parametrize("text", ["1", "yes", ""])
def test_other_words_are_no_truth_values(text: str) -> None:
    with pytest.raises(ParameterError, match="must be of type bool"):
        Configuration().with_values({"sensors.gauge_pressure": text})


def test_a_group_made_by_hand_can_be_checked() -> None:
    check(Sonar(mount_yaw=3.0), "sonar")
    with pytest.raises(ParameterError, match=r"sonar\.mount_yaw = 4\.0: must lie in"):
        check(Sonar(mount_yaw=4.0), "sonar")
