# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The loss curve of one topic in a process of its own, which can be ended at any time.

The order has ``bag``, a path, and ``topic``; the result has the fields of ``web.curve_schemas.CurveAnswer``.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

from smarttestudo.composition.bag_curves import measure_curves
from smarttestudo.composition.ruler.child_messages import Report, answer_order
from smarttestudo.visualizer.loss.curve import CurvePoint, LossCurve, worst_loss


def _work(order: dict[str, Any], report: Report) -> object:
    curves = measure_curves(Path(order["bag"]), topics=[order["topic"]], report=report)
    curve = next(iter(curves.curves), None)
    if curve is None:
        return {"notices": curves.notices}
    proposal = curve.breakpoints
    return {
        "source_hz": curve.source_hz,
        "points": [_point(point, curve) for point in curve.points],
        "tiers_hz": proposal.tiers_hz if proposal else None,
        "notices": curves.notices,
    }


def _point(point: CurvePoint, curve: LossCurve) -> dict[str, object]:
    _, relative, field = worst_loss(point, curve.fields)
    is_known = any(point.errors)
    return {
        "rate_hz": point.rate_hz,
        "kb_per_s": point.kb_per_s,
        "error_percent": 100 * relative if is_known else None,
        "worst_field": field if is_known else None,
        "age_mean_s": point.age.mean_s if point.age else None,
    }


if __name__ == "__main__":
    sys.exit(answer_order(_work))
