# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The MAPE-K loop as a pure step; time and I/O are passed in. Standard library only."""

from smarttestudo.runtime.execute.relay import Relayed
from smarttestudo.runtime.execute.statistics import Flow, RelayStatistics, Target
from smarttestudo.runtime.knowledge.knowledge import Knowledge
from smarttestudo.runtime.relay_loop import RelayLoop
from smarttestudo.runtime.step import StepResult, step

__all__ = [
    "Flow",
    "Knowledge",
    "RelayLoop",
    "RelayStatistics",
    "Relayed",
    "StepResult",
    "Target",
    "step",
]
