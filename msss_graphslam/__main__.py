# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""``python -m msss_graphslam`` is ``msss``."""

from msss_graphslam.cli.main import main

if __name__ == "__main__":
    raise SystemExit(main())
