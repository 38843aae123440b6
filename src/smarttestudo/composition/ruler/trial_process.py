# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A trial in a process of its own, which can be ended at any time.

The order has the fields of ``Draft`` and ``bag``, a path; the result is that of ``trial_to_json``.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

from smarttestudo.composition.ruler.checked_text import Draft
from smarttestudo.composition.ruler.child_messages import Report, answer_order
from smarttestudo.composition.ruler.trial import try_rules
from smarttestudo.composition.ruler.trial_json import trial_to_json


def _work(order: dict[str, Any], report: Report) -> object:
    bag = Path(order.pop("bag"))
    return trial_to_json(try_rules(Draft(**order), bag, report))


if __name__ == "__main__":
    sys.exit(answer_order(_work))
