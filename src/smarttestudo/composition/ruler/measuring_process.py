# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Measures the topics of running robots in a process of its own: JSON in, lines of JSON out.

The one object on standard input has ``seconds`` and ``timeout_s``. The lines are those of a trial; the
``result`` has ``text``, a profile.
"""

from __future__ import annotations

import json
import os
import sys
import time
from typing import Any

from smarttestudo.adapters.ros import open_robot
from smarttestudo.composition.profile_robot import profile_of_robot
from smarttestudo.composition.ruler.process_lines import Reporter, say
from smarttestudo.domain.errors import TestudoError


def main() -> int:
    """Measure as standard input asks."""
    order: dict[str, Any] = json.load(sys.stdin)
    try:
        with open_robot(name=f"testudo_ruler_profile_{os.getpid()}") as robot:
            profile = profile_of_robot(
                robot,
                seconds=float(order["seconds"]),
                timeout_s=float(order["timeout_s"]),
                steady_s=time.monotonic,
                report=Reporter(sys.stdout),
            )
    except TestudoError as error:
        say(sys.stdout, kind="error", message=error.cause, place=error.place, remedy=error.remedy)
        return 1
    say(sys.stdout, kind="result", result={"text": profile.text})
    return 0


if __name__ == "__main__":
    sys.exit(main())
