# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""One stream of random numbers for every random source, all made from one seed."""

import zlib

import numpy as np

from msss_graphslam.errors import UserError

__all__ = ["stream"]


def stream(seed: int, source: str) -> np.random.Generator:
    """Return the generator of the named source; no other source shifts it.

    Raises UserError for a negative seed.
    """
    if seed < 0:
        raise UserError(f"seed = {seed}: must not be negative")
    key = zlib.crc32(source.encode())
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(key,)))
