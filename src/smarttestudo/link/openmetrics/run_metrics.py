# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Metrics of a live run, for a monitoring system."""

from __future__ import annotations

from collections.abc import Sequence

from smarttestudo.domain.decision import AnyDecision, about_rates
from smarttestudo.domain.metric import Metric, MetricKind, MetricName
from smarttestudo.domain.status import RuntimeStatus
from smarttestudo.link.openmetrics.status import status_metrics
from smarttestudo.robot.part import Part

DECISIONS = MetricName(
    name="testudo",
    unit="decisions",
    help="Changes of rates, or of the rules that decide them.",
    kind=MetricKind.COUNTER,
    labels=("robot",),
)


class RunMetrics(Part):
    """The metrics of the last status, under the name ``robot``. Any thread may ask for them."""

    def __init__(self, robot: str) -> None:
        self._robot = robot
        self._status: RuntimeStatus | None = None
        self._decisions = 0

    def on_status(self, status: RuntimeStatus) -> None:
        self._status = status

    def on_decisions(self, decisions: Sequence[AnyDecision]) -> None:
        self._decisions += len(about_rates(decisions))

    def metrics(self) -> list[Metric]:
        status = self._status
        decisions = Metric(name=DECISIONS, samples=[((self._robot,), float(self._decisions))])
        return [decisions, *([] if status is None else status_metrics({self._robot: status}))]
