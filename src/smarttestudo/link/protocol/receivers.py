# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The operator's ends that a robot's end hears, and what they predict."""

from __future__ import annotations

from dataclasses import dataclass

from smarttestudo.link.protocol.messages import Report

MAX_RECEIVERS = 64
"""With more, nothing is known of some, so nothing is reckoned."""


@dataclass(slots=True)
class _Receiver:
    last_ns: int
    predicts: frozenset[str]


class Receivers:
    """The operator's ends that reported within ``lost_after_ns``.

    A receiver that never reported what it predicts predicts nothing.
    """

    def __init__(self, lost_after_ns: int) -> None:
        self._lost_after_ns = lost_after_ns
        self._known: dict[int, _Receiver] = {}

    def handle(self, report: Report, now_ns: int) -> bool:
        """A receiver reported; whether it came while others were there."""
        known = self._known.get(report.receiver)
        has_joined = False
        if known is None:
            self._forget_lost(now_ns)
            if len(self._known) > MAX_RECEIVERS:
                return False
            has_joined = bool(self._known)
            known = self._known[report.receiver] = _Receiver(now_ns, frozenset())
        known.last_ns = now_ns
        known.predicts = report.predicts or known.predicts
        return has_joined

    @property
    def numbers(self) -> frozenset[int]:
        return frozenset(self._known)

    def present(self, now_ns: int) -> frozenset[int]:
        self._forget_lost(now_ns)
        return frozenset(self._known)

    def predicted(self, now_ns: int) -> frozenset[str]:
        """The topics that all of them reckon: nobody is sent what only another one can make use of."""
        self._forget_lost(now_ns)
        if not self._known or len(self._known) > MAX_RECEIVERS:
            return frozenset()
        return frozenset.intersection(*(receiver.predicts for receiver in self._known.values()))

    def _forget_lost(self, now_ns: int) -> None:
        self._known = {
            number: receiver
            for number, receiver in self._known.items()
            if now_ns - receiver.last_ns <= self._lost_after_ns
        }
