# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Work that takes long, in a process of its own, which can be ended at any time.

The one argument is the value of a ``ChildWork``; its order comes on standard input.
"""

from __future__ import annotations

import sys
from enum import Enum
from pathlib import Path

from msgspec import Struct

from smarttestudo.ruler.child_messages import answer_order


class ChildWork(Enum):
    """Kind of work: a request about a bag or an incident, which is a path, or an order of its own."""

    TRIAL = "trial"
    HEADLINE = "headline"
    CURVE = "curve"
    ACCURACY = "accuracy"
    INCIDENT = "incident"
    KEEP = "keep"
    CHECK = "check"
    MEASURE = "measure"


class MeasureOrder(Struct, frozen=True, kw_only=True):
    """How long to measure running robots, and how long to wait for the first topic."""

    seconds: float
    timeout_s: float


def _main(work: ChildWork) -> int:
    match work:
        case ChildWork.TRIAL:
            # Each work loads its own libraries only.
            from smarttestudo.ruler.tries.try_rules import TryRequest, try_rules  # noqa: PLC0415

            return answer_order(TryRequest, lambda order, report: try_rules(order, Path(order.bag), report))
        case ChildWork.HEADLINE:
            from smarttestudo.ruler.tries.try_rules import TryRequest, tried_recording  # noqa: PLC0415

            return answer_order(
                TryRequest, lambda order, report: tried_recording(order, Path(order.bag), report)
            )
        case ChildWork.CURVE:
            from smarttestudo.ruler.topics.curves import CurveRequest, measured_curve  # noqa: PLC0415

            return answer_order(
                CurveRequest, lambda order, report: measured_curve(Path(order.bag), order.topic, report)
            )
        case ChildWork.ACCURACY:
            from smarttestudo.ruler.topics.curves import CurveRequest, measured_needs  # noqa: PLC0415

            return answer_order(
                CurveRequest, lambda order, report: measured_needs(Path(order.bag), order.topic, report)
            )
        case ChildWork.INCIDENT:
            from smarttestudo.ruler.incidents.incidents import IncidentCourseRequest, incident_course  # noqa: PLC0415

            return answer_order(
                IncidentCourseRequest, lambda order, report: incident_course(Path(order.name), report)
            )
        case ChildWork.KEEP:
            from smarttestudo.ruler.tries.incident_keeping import KeepOrder, keep_incident  # noqa: PLC0415

            return answer_order(KeepOrder, keep_incident)
        case ChildWork.CHECK:
            from smarttestudo.ruler.tries.check_course import CheckCourseOrder, check_course  # noqa: PLC0415

            return answer_order(CheckCourseOrder, check_course)
        case ChildWork.MEASURE:
            from smarttestudo.ruler.topics.profiles import measured_on_robots  # noqa: PLC0415

            return answer_order(
                MeasureOrder,
                lambda order, report: measured_on_robots(
                    seconds=order.seconds, timeout_s=order.timeout_s, report=report
                ),
            )


if __name__ == "__main__":
    sys.exit(_main(ChildWork(sys.argv[1])))
