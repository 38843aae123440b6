# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What the robot carries: each device publishes at its own rate."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

from smarttestudo.simulation.drive import DifferentialDrive
from smarttestudo.simulation.readings import Reading, Topic


class Device(Protocol):
    """Something that looks at the robot ``rate_hz`` times a second and publishes what it saw."""

    @property
    def rate_hz(self) -> float:
        """How often it is sampled."""

    def sample(self, drive: DifferentialDrive) -> Sequence[tuple[Topic, Reading]]:
        """What it publishes now; called once each period, in time order."""
