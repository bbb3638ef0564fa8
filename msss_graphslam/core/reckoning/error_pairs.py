# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""The blocks into which dead reckoning's covariance falls.

The filter's states go in pairs that know nothing of each other: roll and pitch, yaw and the
compass' bias, surge and sway, height and heave. Only the place (x, y) depends on several of them,
as the sum of what each pair's errors have moved it by. So the covariance (10, 10) is exactly four
of (4, 4), and a measurement of one state touches one of them. They are of plain numbers: at this
size an array costs more than what is calculated with it.
"""

__all__ = ["CERTAIN", "Four", "Pair", "conditioned", "followed", "propagated", "widened"]

Four = tuple[float, float, float, float]
Pair = tuple[float, float, float, float, float, float, float, float, float, float]
"""Covariances xx, xy, yy, xa, ya, xb, yb, aa, ab, bb; those of x and y by the pair's doing."""

CERTAIN: Pair = (0.0,) * 10
"""Of a pair that is known exactly and has moved nothing."""


def propagated(pair: Pair, onto: Four, own: Four, noise: Four) -> Pair:
    """Return F P F' + Q, equation 8, of one pair.

    ``onto`` are the derivatives of x by a, x by b, y by a, y by b, ``own`` those of a by a, a by
    b, b by a, b by b; ``noise`` is added to the variances of x, y, a, b.
    """
    xx, xy, yy, xa, ya, xb, yb, aa, ab, bb = pair
    x_a, x_b, y_a, y_b = onto
    a_a, a_b, b_a, b_b = own
    noise_x, noise_y, noise_a, noise_b = noise
    moved_xa, moved_xb = xa + x_a * aa + x_b * ab, xb + x_a * ab + x_b * bb
    moved_ya, moved_yb = ya + y_a * aa + y_b * ab, yb + y_a * ab + y_b * bb
    turned_aa, turned_ab = a_a * aa + a_b * ab, a_a * ab + a_b * bb
    turned_ba, turned_bb = b_a * aa + b_b * ab, b_a * ab + b_b * bb
    return (
        xx + x_a * (xa + moved_xa) + x_b * (xb + moved_xb) + noise_x,
        xy + x_a * ya + x_b * yb + y_a * moved_xa + y_b * moved_xb,
        yy + y_a * (ya + moved_ya) + y_b * (yb + moved_yb) + noise_y,
        a_a * moved_xa + a_b * moved_xb,
        a_a * moved_ya + a_b * moved_yb,
        b_a * moved_xa + b_b * moved_xb,
        b_a * moved_ya + b_b * moved_yb,
        a_a * turned_aa + a_b * turned_ab + noise_a,
        b_a * turned_aa + b_b * turned_ab,
        b_a * turned_ba + b_b * turned_bb + noise_b,
    )


def conditioned(pair: Pair, second: bool, variance: float) -> tuple[Four, Pair]:
    """Return the gains of x, y, a, b and the pair after a measurement: equations 9 and 10.

    Measured with ``variance`` is b where ``second`` says so, else a.
    """
    xx, xy, yy, xa, ya, xb, yb, aa, ab, bb = pair
    x, y, a, b = (xb, yb, ab, bb) if second else (xa, ya, aa, ab)
    scale = 1.0 / ((b if second else a) + variance)
    gain_x, gain_y, gain_a, gain_b = gains = x * scale, y * scale, a * scale, b * scale
    return gains, (
        xx - gain_x * x,
        xy - gain_x * y,
        yy - gain_y * y,
        xa - gain_x * a,
        ya - gain_y * a,
        xb - gain_x * b,
        yb - gain_y * b,
        aa - gain_a * a,
        ab - gain_a * b,
        bb - gain_b * b,
    )


def followed(pair: Pair, gain: float, variance: float) -> Pair:
    """Return the pair after a measurement of a + b that a alone follows by any ``gain``.

    This is P. D. Joseph's form, (I - K H) P (I - K H)' + K R K', for K = (0, 0, gain, 0).
    """
    xx, xy, yy, xa, ya, xb, yb, aa, ab, bb = pair
    of_a, of_b = gain * (aa + ab), gain * (ab + bb)
    corrected = aa - 2.0 * of_a + gain * (of_a + of_b + gain * variance)
    xa, ya = xa - gain * (xa + xb), ya - gain * (ya + yb)
    return (xx, xy, yy, xa, ya, xb, yb, corrected, ab - of_b, bb)


def widened(pair: Pair, second: bool, variance: float) -> Pair:
    """Return the pair with ``variance`` added to that of b where ``second`` says so, else of a."""
    xx, xy, yy, xa, ya, xb, yb, aa, ab, bb = pair
    aa, bb = (aa, bb + variance) if second else (aa + variance, bb)
    return (xx, xy, yy, xa, ya, xb, yb, aa, ab, bb)
