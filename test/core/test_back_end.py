# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import least_squares

from msss_graphslam.config.groups import BackEnd as Config
from msss_graphslam.core.compounding import between, compose, compose_jacobians, wrap
from msss_graphslam.core.graph.back_end import BackEnd
from msss_graphslam.core.graph.constraint_defects import defect
from msss_graphslam.core.types import Array, Constraint, ConstraintKind

LEAST_SQUARES = Config(robust_width=0.0)
START = np.array([1.0, -2.0, 0.4])
NODES = 12


def random_covariance(rng: np.random.Generator) -> Array:
    """Not diagonal, so that the axes matter."""
    root = np.diag([0.08, 0.03, 0.01]) @ rng.normal(size=(3, 3))
    return root @ root.T + np.diag([1e-4, 1e-4, 1e-6])


def edge(
    first: int,
    second: int,
    relative: Array,
    covariance: Array | None = None,
    kind: ConstraintKind = ConstraintKind.ODOMETRY,
) -> Constraint:
    spread = np.diag([1e-3, 2e-3, 1e-4]) if covariance is None else covariance
    return Constraint(kind, first, second, relative, spread)


def loop(first: int, second: int, relative: Array, covariance: Array | None = None) -> Constraint:
    return edge(first, second, relative, covariance, ConstraintKind.LOOP)


def ring(seed: int) -> tuple[Array, list[list[Constraint]]]:
    """The truth (n, 3), and for each new keyframe its noisy constraints: a chain and chords."""
    rng = np.random.default_rng(seed)
    truth = [START]
    for _ in range(NODES - 1):
        truth.append(compose(truth[-1], np.array([1.0, 0.1, 0.55]) + rng.normal(0.0, 0.05, 3)))
    steps = []
    for second in range(1, NODES):
        pairs = [(second - 1, second)] + [(second - k, second) for k in (3, 7) if second >= k]
        new = []
        for first, other in pairs:
            covariance = random_covariance(rng)
            exact = between(truth[first], truth[other])
            noisy = exact + rng.multivariate_normal(np.zeros(3), covariance)
            kind = ConstraintKind.ODOMETRY if other - first == 1 else ConstraintKind.LOOP
            new.append(edge(first, other, noisy, covariance, kind))
        steps.append(new)
    return np.array(truth), steps


def batch(constraints: list[Constraint], start: Array) -> tuple[Array, Array]:
    """An oracle: equation 4 by scipy; the poses (n, 3) and the last one's covariance.

    The smoother may differ by half its threshold of linearisation, 0.01.
    """
    roots = [np.linalg.cholesky(np.linalg.inv(c.covariance)).T for c in constraints]

    def residuals(flat: Array) -> Array:
        poses = np.vstack([START, flat.reshape(-1, 3)])
        parts = []
        for constraint, root in zip(constraints, roots, strict=True):
            error = between(poses[constraint.first], poses[constraint.second])
            error = error - constraint.relative_pose
            error[2] = wrap(error[2])
            parts.append(root @ error)
        return np.concatenate(parts)

    found = least_squares(residuals, start[1:].ravel(), xtol=1e-14, ftol=1e-14, gtol=1e-14)
    covariance = np.linalg.inv(found.jac.T @ found.jac)
    return np.vstack([START, found.x.reshape(-1, 3)]), covariance[-3:, -3:]


def fed(steps: list[list[Constraint]], config: Config = LEAST_SQUARES) -> BackEnd:
    back_end = BackEnd(config)
    back_end.add_keyframe(START)
    back_end.update([])
    for new in steps:
        back_end.update(new)
    return back_end


def assert_same_poses(poses: Array, expected: Array, tolerance: float) -> None:
    np.testing.assert_allclose(poses[:, :2], expected[:, :2], atol=tolerance)
    np.testing.assert_allclose(wrap(poses[:, 2] - expected[:, 2]), 0.0, atol=tolerance)


@pytest.mark.parametrize("seed", range(4))
def test_equals_batch_least_squares(seed: int) -> None:
    truth, steps = ring(seed)
    back_end = fed(steps)
    expected, covariance = batch(back_end.constraints, truth)
    assert_same_poses(back_end.poses(), expected, 0.005)
    computed = back_end.covariance(NODES - 1)
    ratios = np.linalg.eigvals(np.linalg.solve(covariance, computed)).real
    np.testing.assert_allclose(ratios, 1.0, atol=0.1)


def test_the_covariance_is_in_the_axes_of_the_map() -> None:
    relative, covariance = np.array([2.0, -1.0, 0.8]), random_covariance(np.random.default_rng(0))
    back_end = fed([[edge(0, 1, relative, covariance)]])
    _, by_second = compose_jacobians(START, relative)
    expected = by_second @ covariance @ by_second.T
    np.testing.assert_allclose(back_end.covariance(1), expected, rtol=1e-6, atol=1e-9)


def test_covariances_are_compounded_along_a_chain() -> None:
    rng = np.random.default_rng(1)
    relatives = rng.normal([1.0, 0.0, 0.5], 0.2, (5, 3))
    covariances = [random_covariance(rng) for _ in range(5)]
    back_end = fed(
        [[edge(k, k + 1, relatives[k], covariances[k])] for k in range(5)],
    )
    pose, expected = START, np.zeros((3, 3))
    for relative, covariance in zip(relatives, covariances, strict=True):
        by_first, by_second = compose_jacobians(pose, relative)
        expected = by_first @ expected @ by_first.T + by_second @ covariance @ by_second.T
        pose = compose(pose, relative)
    np.testing.assert_allclose(back_end.poses()[-1], pose, atol=1e-9)
    np.testing.assert_allclose(back_end.covariance(5), expected, rtol=1e-5, atol=1e-9)


def test_the_first_keyframe_stays_where_it_was_launched() -> None:
    _, steps = ring(5)
    back_end = fed(steps)
    np.testing.assert_allclose(back_end.poses()[0], START, atol=1e-6)
    assert np.abs(back_end.covariance(0)).max() < 1e-9


def test_a_loop_makes_the_last_pose_surer() -> None:
    chain = [[edge(k, k + 1, np.array([1.0, 0.0, 0.5]))] for k in range(8)]
    back_end = fed(chain)
    before = np.linalg.eigvalsh(back_end.covariance(8))
    poses = back_end.poses()
    back_end.update([loop(0, 8, between(poses[0], poses[8]))])
    assert (np.linalg.eigvalsh(back_end.covariance(8)) < before).all()


def test_without_keyframes_there_are_no_poses() -> None:
    assert BackEnd(LEAST_SQUARES).poses().shape == (0, 3)


def test_the_same_graph_gives_the_same_bits() -> None:
    _, steps = ring(6)
    np.testing.assert_array_equal(fed(steps).poses(), fed(steps).poses())


def test_a_keyframe_may_be_given_before_its_constraint() -> None:
    back_end = fed([])
    assert back_end.add_keyframe(np.array([2.1, -1.6, 0.4])) == 1
    poses = back_end.update([edge(0, 1, np.array([1.0, 0.0, 0.1]))])
    np.testing.assert_allclose(poses[1], compose(START, np.array([1.0, 0.0, 0.1])), atol=1e-6)


VALID = edge(0, 1, np.array([1.0, 0.0, 0.0]))
ASYMMETRIC = np.diag([1e-3, 1e-3, 1e-3])
ASYMMETRIC[0, 1] = 1e-4


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({}, ""),
        ({"first": -1}, "unknown_keyframe"),
        ({"second": 2}, "unknown_keyframe"),
        ({"first": 1}, "joins_a_keyframe_to_itself"),
        ({"relative_pose": np.array([np.nan, 0.0, 0.0])}, "not_finite"),
        ({"relative_pose": np.array([0.0, np.inf, 0.0])}, "not_finite"),
        ({"covariance": np.diag([np.nan, 1.0, 1.0])}, "not_finite"),
        ({"covariance": ASYMMETRIC}, "covariance_not_symmetric"),
        ({"covariance": np.diag([1.0, 1.0, 0.0])}, "covariance_not_positive_definite"),
        ({"covariance": np.diag([1.0, 1.0, -1e-9])}, "covariance_not_positive_definite"),
        ({"covariance": np.diag([1.0, 1.0, 1e-9])}, ""),
        ({"covariance": np.diag([1e-3] * 3) + 1e-12 * ASYMMETRIC}, ""),
    ],
)
def test_every_defect_has_its_reason(changes: dict[str, object], reason: str) -> None:
    assert defect(replace(VALID, **changes), keyframes=2) == reason


@pytest.mark.parametrize(
    "bad",
    [
        edge(0, 1, np.array([np.nan, 0.0, 0.0])),
        edge(0, 0, np.zeros(3)),
        edge(0, 4, np.zeros(3)),
        edge(3, 1, np.zeros(3)),
        edge(3, 3, np.zeros(3)),
        edge(0, 2, np.zeros(3), np.zeros((3, 3))),
    ],
)
@pytest.mark.parametrize("good_before", [False, True])
def test_a_refused_update_leaves_the_graph_as_it_was(bad: Constraint, good_before: bool) -> None:
    """Three keyframes; a constraint to keyframe 3 would bring it, 4 would leave a hole."""
    steps = [[edge(k, k + 1, np.array([1.0, 0.0, 0.5]))] for k in range(2)]
    back_end = fed(steps)
    poses, constraints = back_end.poses(), list(back_end.constraints)
    good = [loop(0, 2, np.array([2.5, 0.4, 1.2]))] if good_before else []
    with pytest.raises(ValueError, match=f"{bad.first} -> {bad.second}: "):
        back_end.update([*good, bad])
    assert back_end.constraints == constraints
    np.testing.assert_array_equal(back_end.poses(), poses)
    new = edge(2, 3, np.array([1.0, 0.0, 0.5]))
    after = back_end.update([new])
    np.testing.assert_allclose(after[3], compose(poses[2], new.relative_pose), atol=1e-6)


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_a_pose_that_is_not_finite_is_refused(value: float) -> None:
    back_end = fed([])
    with pytest.raises(ValueError, match="keyframe 1 is not finite"):
        back_end.add_keyframe(np.array([0.0, value, 0.0]))
    assert len(back_end.poses()) == 1


def test_one_update_may_bring_several_keyframes() -> None:
    chain = [edge(k, k + 1, np.array([1.0, 0.2, 0.3])) for k in range(6)]
    at_once = fed([chain])
    one_by_one = fed([[entry] for entry in chain])
    assert_same_poses(at_once.poses(), one_by_one.poses(), 1e-9)


def test_the_smoother_is_made_anew_after_a_failure(monkeypatch: pytest.MonkeyPatch) -> None:
    truth, steps = ring(7)
    undisturbed, back_end = fed(steps), fed(steps[:6])

    class Broken:
        def update(self, *_: object) -> None:
            raise RuntimeError("indeterminate linear system")

        def calculateEstimatePose2(self, node: int) -> object:  # noqa: N802
            return healthy.calculateEstimatePose2(node)

    healthy = back_end._isam
    monkeypatch.setattr(back_end, "_isam", Broken())
    for new in steps[6:]:
        back_end.update(new)
    assert_same_poses(back_end.poses(), undisturbed.poses(), 1e-3)
    assert len(truth) == len(back_end.poses())


def wrong_loop(config: Config) -> float:
    """The farthest that one wrong loop closure moves a keyframe of a good graph [m]."""
    truth, steps = ring(8)
    good, spoilt = fed(steps, config), fed(steps, config)
    wrong = between(truth[1], truth[9]) + np.array([3.0, -2.0, 0.5])
    spoilt.update([loop(1, 9, wrong, np.diag([0.05, 0.05, 0.01]) ** 2)])
    return float(np.linalg.norm((spoilt.poses() - good.poses())[:, :2], axis=1).max())


def test_one_wrong_loop_does_little() -> None:
    assert wrong_loop(Config()) < 0.1
    assert wrong_loop(LEAST_SQUARES) > 0.5


def test_the_kernel_spares_the_odometry() -> None:
    """Only loop closures are doubted: two contradicting odometry edges meet in the middle."""
    apart = [edge(0, 1, np.array([x, 0.0, 0.0])) for x in (1.0, 3.0)]
    back_end = fed([apart], Config())
    distance = np.linalg.norm(back_end.poses()[1, :2] - START[:2])
    assert distance == pytest.approx(2.0, abs=1e-3)


def test_the_first_keyframe_taken_lies_where_it_says() -> None:
    back_end = BackEnd(LEAST_SQUARES)
    poses, covariance = back_end.take(START, [])
    np.testing.assert_allclose(poses, START[None], atol=1e-9)
    assert np.abs(covariance).max() < 1e-9


@pytest.mark.parametrize("seed", range(2))
def test_taking_keyframe_by_keyframe_is_updating(seed: int) -> None:
    _, steps = ring(seed)
    back_end, expected = BackEnd(LEAST_SQUARES), fed(steps)
    back_end.take(START, [])
    for new in steps:
        poses, covariance = back_end.take(np.full(3, 99.0), new)
    np.testing.assert_array_equal(poses, expected.poses())
    np.testing.assert_array_equal(covariance, expected.covariance(NODES - 1))


def test_only_the_first_keyframe_s_own_pose_counts() -> None:
    back_end = BackEnd(LEAST_SQUARES)
    back_end.take(START, [])
    relative = np.array([1.0, 0.0, 0.1])
    poses, _ = back_end.take(np.array([50.0, 50.0, 1.0]), [edge(0, 1, relative)])
    assert_same_poses(poses, np.vstack([START, compose(START, relative)]), 1e-9)


def test_what_was_refused_is_not_taken() -> None:
    back_end, relative = BackEnd(LEAST_SQUARES), np.array([1.0, 0.0, 0.1])
    back_end.take(START, [])
    wrong = replace(loop(0, 1, np.array([9.0, 9.0, 1.0])), refusal="too_little_overlap")
    accepted = edge(0, 1, relative)
    poses, _ = back_end.take(START, [wrong, accepted])
    assert_same_poses(poses, np.vstack([START, compose(START, relative)]), 1e-9)
    assert back_end.constraints == [accepted]


def test_matches_of_one_scan_share_its_weight() -> None:
    """Three matches with the scan's own error in common say no more than one of them."""
    step, spread = np.array([1.0, 0.1, 0.2]), np.diag([1e-2, 2e-2, 1e-3])
    found = []
    for count in (1, 3):
        back_end = BackEnd(LEAST_SQUARES, divides=True)
        back_end.add_keyframe(START)
        back_end.update([])
        for number in range(3):
            back_end.update([edge(number, number + 1, np.zeros(3), 1e-9 * np.eye(3))])
        back_end.update([loop(number, 4, step, spread) for number in range(count)])
        found.append(back_end.covariance(4))
        assert_same_poses(back_end.poses()[4:], compose(START, step)[None], 1e-3)
    np.testing.assert_allclose(found[0], found[1], rtol=1e-3, atol=1e-7)


def test_odometry_keeps_its_own_weight_beside_matches() -> None:
    step, spread = np.array([1.0, 0.1, 0.2]), np.diag([1e-2, 2e-2, 1e-3])
    edges = [edge(0, 1, step, spread), loop(0, 1, step, spread)]
    found = []
    for new in (edges, edges[1:]):
        back_end = BackEnd(LEAST_SQUARES, divides=True)
        back_end.add_keyframe(START)
        back_end.update([])
        back_end.update(new)
        found.append(back_end.covariance(1))
    np.testing.assert_allclose(2.0 * found[0], found[1], rtol=1e-3, atol=1e-9)


def test_a_rebuilt_smoother_has_the_same_shares() -> None:
    _, steps = ring(3)
    back_end = BackEnd(LEAST_SQUARES, divides=True)
    back_end.add_keyframe(START)
    back_end.update([])
    for new in steps:
        back_end.update(new)
    before = back_end.poses(), back_end.covariance(NODES - 1)
    back_end._rebuild()
    back_end.update([])
    np.testing.assert_allclose(back_end.poses(), before[0], atol=5e-3)
    np.testing.assert_allclose(back_end.covariance(NODES - 1), before[1], rtol=0.1, atol=1e-6)
