# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Memory that is free within the process goes back to the system."""

# A day's graph is a million small pieces among others that stay. Without a word, glibc keeps the
# gaps for pieces as small; the large arrays of joint smoothing come on top.

import ctypes

__all__ = ["give_back"]


def give_back() -> None:
    """Return what has been freed to the system, where its C library can do so on demand."""
    trim = getattr(ctypes.CDLL(None), "malloc_trim", None)
    if trim is not None:
        trim(0)
