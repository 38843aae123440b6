# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Measures the topics of running robots in a process of its own, which can be ended at any time.

The order is a ``MeasureOrder``; the result is a profile.
"""

from __future__ import annotations

import os
import sys
import time

from msgspec import Struct

from smarttestudo.adapters.ros import open_robot
from smarttestudo.use_cases.live.profile import profile_of_robot
from smarttestudo.use_cases.ruler.child_messages import Report, answer_order
from smarttestudo.use_cases.ruler.edits import TextAnswer


class MeasureLiveRequest(Struct, frozen=True, kw_only=True):
    """``POST /api/profile/measure-live`` → ``TextAnswer``: a profile of what the robot's nodes publish now.

    ``run`` names it in the ``Progress`` messages of ``/ws``.
    """

    seconds: float
    run: str = ""


class MeasureOrder(Struct, frozen=True, kw_only=True):
    """How long to measure, and how long to wait for the first topic."""

    seconds: float
    timeout_s: float


def _work(order: MeasureOrder, report: Report) -> TextAnswer:
    with open_robot(name=f"testudo_ruler_profile_{os.getpid()}") as robot:
        profile = profile_of_robot(
            robot, seconds=order.seconds, timeout_s=order.timeout_s, steady_s=time.monotonic, report=report
        )
    return TextAnswer(text=profile.text)


if __name__ == "__main__":
    sys.exit(answer_order(MeasureOrder, _work))
