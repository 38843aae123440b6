# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Publishes and logs the decisions of a live run."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from smarttestudo.domain.action import ActionDecision, action_line
from smarttestudo.domain.decision import AnyDecision, Decision, PlannedRate, Reason
from smarttestudo.domain.errors import said
from smarttestudo.domain.names import DECISIONS_TOPIC
from smarttestudo.domain.robot import Qos, Robot
from smarttestudo.loop.decision_log import decision_text

# Late subscribers get the last decisions, so that they see which plan holds.
DECISIONS_QOS = Qos(reliable=True, transient_local=True, depth=100)

Decided = Callable[[Sequence[AnyDecision]], None]
"""Takes decisions in order. One that raises gets no more."""


class LiveDecisions:
    """Gives decisions to ``decided``, the node's log and ``DECISIONS_TOPIC``. May raise ``RosError``."""

    def __init__(self, robot: Robot, decided: Sequence[Decided]) -> None:
        self._robot = robot
        self._announce = robot.text_publisher(DECISIONS_TOPIC, DECISIONS_QOS)
        self._decided: list[Decided] = [*decided, self._log, self._announce_all]

    def report(self, decisions: Sequence[AnyDecision]) -> None:
        """Pass ``decisions`` to everything that still takes them."""
        if decisions:
            self._decided = [decided for decided in self._decided if self._took(decided, decisions)]

    def _took(self, decided: Decided, decisions: Sequence[AnyDecision]) -> bool:
        try:
            decided(decisions)
        except Exception as error:  # noqa: BLE001 - whatever publishing fails of, relaying goes on
            self._robot.log.warning(f"{said(error)}; no further decisions are written there")
            return False
        return True

    def _log(self, decisions: Sequence[AnyDecision]) -> None:
        for decision in decisions:
            if isinstance(decision, ActionDecision) or not _is_same_by_reload(decision):
                self._robot.log.info(decision_line(decision))

    def _announce_all(self, decisions: Sequence[AnyDecision]) -> None:
        for decision in decisions:
            self._announce(decision_text(decision))


def _is_same_by_reload(decision: Decision) -> bool:
    """Whether a reload gave a topic the same rate by another block."""
    is_same = decision.from_rate == decision.planned.rate and not decision.is_end
    return is_same and decision.planned.reason is Reason.RELOAD


def decision_line(decision: AnyDecision) -> str:
    """A decision for the log: what changed, and why."""
    if isinstance(decision, ActionDecision):
        return action_line(decision)
    planned = decision.planned
    if decision.is_end:
        return f"{decision.topic}: no longer relayed ({planned.reason.value})"
    before = "" if decision.from_rate is None else f"{decision.from_rate} → "
    return f"{decision.topic}: {before}{planned.rate} ({reason_words(planned)})"


def reason_words(planned: PlannedRate) -> str:
    """The reason of a rate with the rule's name, if one decided."""
    return planned.reason.value if planned.rule is None else f"{planned.reason.value}: {planned.rule}"
