# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import pytest

from simulation.missions import readings
from smarttestudo.simulation.readings import TimedReading


@pytest.fixture(scope="session")
def patrol_readings() -> list[TimedReading]:
    """One whole round of the warehouse."""
    return readings(200)
