# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A trial in a process of its own, which can be ended at any time.

The order is a ``TryRequest`` whose ``bag`` is a path; the result is a ``TryAnswer``.
"""

from __future__ import annotations

import sys
from pathlib import Path

from smarttestudo.use_cases.ruler.child_messages import Report, answer_order
from smarttestudo.use_cases.ruler.trial import TryAnswer, TryRequest, try_rules


def _work(order: TryRequest, report: Report) -> TryAnswer:
    return try_rules(order, Path(order.bag), report)


if __name__ == "__main__":
    sys.exit(answer_order(TryRequest, _work))
