# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What a page is told of a robot."""

from __future__ import annotations

from dataclasses import replace

from robot.status.statuses import STATUS
from smarttestudo.ruler.answers.live_view import live_model
from smarttestudo.ruler.answers.robot_watch import RuleWords, SeenRobot


def test_watching_says_what_it_takes_of_the_link() -> None:
    status = replace(STATUS, status_hz=20.0)
    seen = SeenRobot(status=status, heard_s=0.0, size_bytes=1500, words=RuleWords())
    assert live_model(seen).status_kb_per_s == 30
