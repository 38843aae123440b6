# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What the log says of a reload: the rates that it changes, and nothing of those that it does not."""

from __future__ import annotations

from typing import Any

import pytest

from loop.loop_driver import ODOMETRY, SECOND, LoopDriver
from robot.small_graph import SmallGraph
from smarttestudo.robot.decisions import LiveDecisions

RULES = """
begin
SetFrequency /scan 8
SetFrequency /tilt Off
SetFrequency /odom 5
KeepWithin /odom position 0.1
Rule "zone" If CheckValue /odom pose_x > 5 Then SetFrequency /imu 10 EndIf
end
"""


@pytest.mark.parametrize(
    ("before", "after", "logged"),
    [
        ("", "", []),
        ('Rule "zone"', '// A comment\nRule "zone"', []),
        ('"zone"', '"corridor"', []),
        ("> 5 Then", "> 5.5 Then", []),
        ("EndIf", "EndIf SetFrequency /imu 10", []),
        (
            'Rule "zone" If',
            'Rule "all" If CheckValue /odom pose_y < 9 Then SetFrequency /imu 10 EndIf If',
            [],
        ),
        ("/imu 10", "/imu 11", ["/imu: 10 Hz → 11 Hz (reload: zone)"]),
        ("/scan 8", "/scan 9", ["/scan: 8 Hz → 9 Hz (reload)"]),
        ("0.1", "0.2", []),
        ("SetFrequency /scan 8", "", ["/scan: no longer relayed (reload)"]),
        ("SetFrequency /tilt Off", "", ["/tilt: no longer relayed (reload)"]),
        ("SetFrequency /scan 8", "SetFrequency /scan 8 SetFrequency /map 1", ["/map: 1 Hz (reload)"]),
    ],
)
def test_a_reload_logs_the_rates_that_it_changes_and_no_others(
    before: str, after: str, logged: list[str]
) -> None:
    graph = SmallGraph()
    kept: list[Any] = []
    decisions = LiveDecisions(graph, [kept.extend])
    driver = LoopDriver(RULES, types={"/odom": ODOMETRY})
    driver.drive(SECOND, 6.0, 0.0)
    driver.wait_until(2 * SECOND)
    driver.decisions.clear()
    driver.reload(RULES.replace(before, after, 1) if before else RULES)
    decisions.report(driver.decisions)
    assert graph.lines == logged
    assert kept == driver.decisions, "who decides now, and within which bound, is kept all the same"
