# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What a monitoring system gets of a live run."""

from __future__ import annotations

from collections.abc import Sequence

from smarttestudo.domain.decision import Decision
from smarttestudo.domain.metric import Metric, MetricKind, MetricName
from smarttestudo.domain.status import RuntimeStatus
from smarttestudo.link.openmetrics.status import status_metrics

DECISIONS = MetricName(
    name="testudo",
    unit="decisions",
    help="Changes of rates, or of the rules that decide them.",
    kind=MetricKind.COUNTER,
    labels=("robot",),
)


class RunMetrics:
    """The metrics of the last status, under the name ``robot``. Any thread may ask for them."""

    def __init__(self, robot: str) -> None:
        self._robot = robot
        self._status: RuntimeStatus | None = None
        self._decisions = 0

    def note_status(self, status: RuntimeStatus) -> None:
        """A status was made."""
        self._status = status

    def note_decisions(self, decisions: Sequence[Decision]) -> None:
        """Decisions were taken."""
        self._decisions += len(decisions)

    def metrics(self) -> list[Metric]:
        """All that is known now."""
        status = self._status
        decisions = Metric(name=DECISIONS, samples=[((self._robot,), float(self._decisions))])
        return [decisions, *([] if status is None else status_metrics({self._robot: status}))]
