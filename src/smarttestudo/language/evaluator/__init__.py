# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The one evaluator: values of signals to a requested rate for each topic, incrementally.

``literal`` has the parts of conditions, ``graph`` joins them and carries the change of a value to the blocks,
``arbiter`` picks the block that decides a topic, ``explanation`` says which values would change its rate.
"""

from smarttestudo.language.evaluator.arbiter import RequestedRate
from smarttestudo.language.evaluator.evaluator import Evaluator
from smarttestudo.language.evaluator.explanation import (
    ExplainedValue,
    RateBorder,
    RateExplanation,
    explain,
    explain_block,
)

__all__ = [
    "Evaluator",
    "ExplainedValue",
    "RateBorder",
    "RateExplanation",
    "RequestedRate",
    "explain",
    "explain_block",
]
