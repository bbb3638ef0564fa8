# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""Foreign recordings made into bags that the package reads."""

from msss_graphslam.recordings.conversion.convert import FORMATS, ConversionReport, convert

__all__ = ["FORMATS", "ConversionReport", "convert"]
