# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The one evaluator: values of signals to a requested rate for each topic, incrementally.

``literal`` has the parts of conditions, ``graph`` joins them and carries the change of a value to the blocks,
``evaluator`` picks the block that decides a topic.
"""

from smarttestudo.language.evaluator.evaluator import Evaluator, RequestedRate

__all__ = ["Evaluator", "RequestedRate"]
