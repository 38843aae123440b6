# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The MAPE-K loop; time and I/O are passed in. Standard library only.

``RelayLoop.handle`` is given each input (``inputs``): it lets ``step`` monitor, analyze and plan on one
``knowledge``, and ``relays`` execute the plan. ``reload`` is how other rules take the place of those before.
"""

from smarttestudo.loop.inputs import ChangeInput, GraphInput, LoopInput, MessageInput, RulesInput, WakeInput
from smarttestudo.loop.knowledge.knowledge import Knowledge
from smarttestudo.loop.relay import Relayed
from smarttestudo.loop.relay_loop import RelayLoop
from smarttestudo.loop.statistics import RelayStatistics, TargetRate
from smarttestudo.loop.step import StepResult, step

__all__ = [
    "ChangeInput",
    "GraphInput",
    "Knowledge",
    "LoopInput",
    "MessageInput",
    "RelayLoop",
    "RelayStatistics",
    "Relayed",
    "RulesInput",
    "StepResult",
    "TargetRate",
    "WakeInput",
    "step",
]
