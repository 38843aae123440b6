# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import pytest

from simulation.missions import driven
from smarttestudo.simulation.messages import TimedMessage


@pytest.fixture(scope="session")
def patrol_messages() -> list[TimedMessage]:
    """One whole round of the warehouse."""
    return driven(200)
