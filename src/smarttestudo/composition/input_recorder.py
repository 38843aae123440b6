# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What a live loop is given, recorded while it runs."""

from __future__ import annotations

from collections.abc import Callable

from smarttestudo.composition.live_rules import LiveRules
from smarttestudo.composition.run_parameters import RunRequest
from smarttestudo.domain.decision import Reason
from smarttestudo.domain.errors import TestudoError
from smarttestudo.domain.robot import Robot
from smarttestudo.runtime.inputs import LoopInput, RulesInput
from smarttestudo.runtime.recording_loop import RecordingLoop
from smarttestudo.runtime.relay_loop import RelayLoop

Note = Callable[[LoopInput], None]
"""Keeps an input; may raise ``TestudoError``."""


class InputRecorder:
    """Makes the loop of a run, and has ``note`` keep what it is given, if there is one, until it fails."""

    def __init__(self, robot: Robot, request: RunRequest, note: Note | None) -> None:
        self._robot = robot
        self._request = request
        self._note = note

    def loop(self, rules: LiveRules, start_ns: int) -> RelayLoop:
        """A loop that starts with ``rules``."""
        request = self._request
        if self._note is None:
            return RelayLoop(
                rules.rule_set, rules.profile, start_ns, request.when_slow, request.budget_kb_per_s
            )
        self.note_rules(rules, start_ns)
        return RecordingLoop(
            rules.rule_set,
            rules.profile,
            start_ns,
            request.when_slow,
            request.budget_kb_per_s,
            note=self._keep,
        )

    def note_rules(self, rules: LiveRules, now_ns: int) -> None:
        """``rules`` hold from now on."""
        if self._note is None:
            return
        is_fallback = rules.rule_set.default_reason is Reason.FALLBACK
        self._keep(
            RulesInput(
                stamp_ns=now_ns,
                rule_texts=rules.texts,
                profile_text=rules.profile_text,
                names=rules.names,
                when_slow=self._request.when_slow,
                budget_kb_per_s=self._request.budget_kb_per_s,
                relay_all=rules.rule_set.relayed if is_fallback else None,
            )
        )

    def _keep(self, given: LoopInput) -> None:
        if self._note is None:
            return
        try:
            self._note(given)
        except TestudoError as error:
            self._note = None
            self._robot.log.warning(f"{error}; no further inputs are recorded")
