# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The robot's own driver."""

from __future__ import annotations

from collections.abc import Sequence

from smarttestudo.simulation.drive import DifferentialDrive
from smarttestudo.simulation.pursuit import PurePursuit
from smarttestudo.simulation.readings import Command, Reading, Topic


class Navigator:
    """Steers the robot along its route and publishes what it asks of the wheels."""

    rate_hz = 10.0

    def __init__(self, pursuit: PurePursuit) -> None:
        self._pursuit = pursuit

    def sample(self, drive: DifferentialDrive) -> Sequence[tuple[Topic, Reading]]:
        """Command the wheels anew."""
        velocity = self._pursuit.command(drive.pose)
        drive.command(velocity)
        return [(Topic.CMD_VEL, Command(velocity=velocity))]
