# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The MAPE-K loop; time and I/O are passed in. Standard library only.

``RelayLoop.take`` is given each input (``inputs``): it lets ``step`` monitor, analyze and plan on one
``knowledge``, and ``relays`` execute the plan. ``reload`` is how other rules take the place of those before.
"""

from smarttestudo.runtime.inputs import ChangeInput, LoopInput, MessageInput, RulesInput, WakeInput
from smarttestudo.runtime.knowledge.knowledge import Knowledge
from smarttestudo.runtime.relay import Relayed
from smarttestudo.runtime.relay_loop import RelayLoop
from smarttestudo.runtime.statistics import RelayStatistics, TargetRate
from smarttestudo.runtime.step import StepResult, step

__all__ = [
    "ChangeInput",
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
