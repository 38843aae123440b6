# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The loss curve of one topic in a process of its own, which can be ended at any time.

The order is a ``CurveRequest`` whose ``bag`` is a path; the result is a ``Curve``.
"""

from __future__ import annotations

import sys
from pathlib import Path

from smarttestudo.use_cases.ruler.child_messages import Report, answer_order
from smarttestudo.use_cases.ruler.curve import Curve, CurveRequest, measured_curve


def _work(order: CurveRequest, report: Report) -> Curve:
    return measured_curve(Path(order.bag), order.topic, report)


if __name__ == "__main__":
    sys.exit(answer_order(CurveRequest, _work))
