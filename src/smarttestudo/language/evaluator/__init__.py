# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The one evaluator: values of signals to a requested rate for each topic, incrementally.

``graph`` turns conditions into leaves and joins, ``thresholds`` finds the leaves that a value changes,
``propagation`` carries the change to the blocks, ``arbiter`` picks the block that decides a topic.
"""

from smarttestudo.language.evaluator.evaluator import Evaluator
from smarttestudo.language.evaluator.rate_arbiter import RequestedRate

__all__ = ["Evaluator", "RequestedRate"]
