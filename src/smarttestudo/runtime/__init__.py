# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The MAPE-K loop as a pure step; time and I/O are passed in. Standard library only."""

from smarttestudo.runtime.knowledge.knowledge import Knowledge
from smarttestudo.runtime.step import StepResult, step

__all__ = ["Knowledge", "StepResult", "step"]
