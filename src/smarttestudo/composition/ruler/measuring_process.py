# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Measures the topics of running robots in a process of its own, which can be ended at any time.

The order has ``seconds`` and ``timeout_s``; the result has ``text``, a profile.
"""

from __future__ import annotations

import os
import sys
import time
from typing import Any

from smarttestudo.adapters.ros import open_robot
from smarttestudo.composition.profile_robot import profile_of_robot
from smarttestudo.composition.ruler.child_messages import Report, answer_order


def _work(order: dict[str, Any], report: Report) -> object:
    with open_robot(name=f"testudo_ruler_profile_{os.getpid()}") as robot:
        profile = profile_of_robot(
            robot,
            seconds=float(order["seconds"]),
            timeout_s=float(order["timeout_s"]),
            steady_s=time.monotonic,
            report=report,
        )
    return {"text": profile.text}


if __name__ == "__main__":
    sys.exit(answer_order(_work))
