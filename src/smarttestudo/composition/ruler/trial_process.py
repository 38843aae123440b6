# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A trial in a process of its own, which can be ended at any time: JSON in, lines of JSON out.

The one object on standard input has the fields of ``Draft`` and ``bag``, a path. Each line on standard output
is an object whose ``kind`` is ``progress`` (``share``), ``result`` (``result``) or ``error`` (``message``,
``place``, ``remedy``).
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

from smarttestudo.composition.ruler.checked_text import Draft
from smarttestudo.composition.ruler.process_lines import Reporter, say
from smarttestudo.composition.ruler.trial import Trial, try_rules
from smarttestudo.domain.errors import TestudoError


def main() -> int:
    """Run the trial that standard input asks for."""
    order: dict[str, Any] = json.load(sys.stdin)
    bag = Path(order.pop("bag"))
    try:
        trial = try_rules(Draft(**order), bag, Reporter(sys.stdout))
    except TestudoError as error:
        say(sys.stdout, kind="error", message=error.cause, place=error.place, remedy=error.remedy)
        return 1
    say(sys.stdout, kind="result", result=_to_json(trial))
    return 0


def _to_json(trial: Trial) -> dict[str, object]:
    return {
        "duration_s": trial.duration_s,
        "bin_s": trial.bin_s,
        "before_kb": trial.before_kb,
        "after_kb": trial.after_kb,
        "percent": trial.saved_percent,
        "decisions": [decision.to_json() for decision in trial.decisions],
        "decision_count": trial.decision_count,
        "topics": [
            {
                "topic": one.topic,
                "before_kb": one.before_kb,
                "after_kb": one.after_kb,
                "before_messages": one.before_messages,
                "after_messages": one.after_messages,
                "target_hz": one.target_hz,
                "before_hz_bins": one.before_hz_bins,
                "after_hz_bins": one.after_hz_bins,
            }
            for one in trial.topics
        ],
        "path": [[point.t_s, point.x_m, point.y_m] for point in trial.path],
        "notices": trial.notices,
    }


if __name__ == "__main__":
    sys.exit(main())
