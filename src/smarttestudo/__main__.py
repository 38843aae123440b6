# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""``python -m smarttestudo`` is ``testudo``."""

import sys

from smarttestudo.cli.main import main

if __name__ == "__main__":
    sys.exit(main())
