# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The inputs of a live loop, recorded while it runs."""

from __future__ import annotations

from collections.abc import Callable, Hashable

from smarttestudo.domain.decision import Reason
from smarttestudo.domain.errors import said
from smarttestudo.domain.observation import Undecodable
from smarttestudo.domain.robot import Robot
from smarttestudo.loop.inputs import LoopInput, MessageInput, RecordedInput, RulesInput, RuleTextsInput
from smarttestudo.loop.relay_loop import RelayLoop
from smarttestudo.robot.live_rules import LiveRules
from smarttestudo.robot.option import Settings
from smarttestudo.robot.run_options import BUDGET, WHEN_SLOW

Note = Callable[[RecordedInput], None]
"""Keeps an input; may raise ``TestudoError``."""


class InputRecorder:
    """Makes the loop of a run, and passes its inputs to ``note``, if there is one, until that fails."""

    def __init__(self, robot: Robot, settings: Settings, note: Note | None) -> None:
        self._robot = robot
        self._settings = settings
        self._note = note
        self.is_recording = note is not None
        """Whether the inputs are recorded, until that fails."""
        self._publishers: dict[Hashable, int] = {}

    def loop(self, rules: LiveRules, start_ns: int) -> RelayLoop:
        """A loop that starts with ``rules``."""
        settings, rule_set, profile = self._settings, rules.rule_set, rules.profile
        self.record(RulesInput(stamp_ns=start_ns, rule_set=rule_set, profile=profile), rules)
        return RelayLoop(rule_set, profile, start_ns, settings[WHEN_SLOW], settings[BUDGET])

    def record(self, given: LoopInput, rules: LiveRules) -> None:
        """Keep an input that the loop is about to take; ``rules`` are those in force with it."""
        if self._note is None:
            return
        try:
            self._note(self._recorded(given, rules))
        except Exception as error:  # noqa: BLE001 - whatever recording fails of, relaying goes on
            self._note, self.is_recording = None, False
            self._robot.log.warning(f"{said(error)}; no further inputs are recorded")

    def _recorded(self, given: LoopInput, rules: LiveRules) -> RecordedInput:
        match given:
            case MessageInput():
                return self._recorded_message(given)
            case RulesInput(stamp_ns=now_ns):
                return self._recorded_rules(rules, now_ns)
        return given

    def _recorded_message(self, given: MessageInput) -> MessageInput:
        """With a copy of what a check reads: the payload may be lent."""
        is_undecodable = isinstance(given.message, Undecodable)
        is_read = given.message is not None and not is_undecodable
        return MessageInput(
            stamp_ns=given.stamp_ns,
            topic=given.topic,
            payload=given.payload[:] if is_read else b"",
            size_bytes=given.size_bytes,
            message=given.message if is_undecodable else None,
            publisher=self._number(given.publisher),
        )

    def _recorded_rules(self, rules: LiveRules, now_ns: int) -> RuleTextsInput:
        rule_set = rules.rule_set
        is_fallback = rule_set.default_reason is Reason.FALLBACK
        finite = {topic: rate.hz for topic, rate in rule_set.defaults.items() if not rate.is_full}
        return RuleTextsInput(
            stamp_ns=now_ns,
            rule_texts=rules.texts,
            profile_text=rules.profile_text,
            names=rules.names,
            known=rules.known,
            when_slow=self._settings[WHEN_SLOW],
            budget_kb_per_s=self._settings[BUDGET],
            relay_all=rule_set.relayed if is_fallback else None,
            fallback_hz=finite if is_fallback else {},
            fallback_floors_hz=rule_set.floors_hz if is_fallback else {},
        )

    def _number(self, publisher: Hashable) -> int | None:
        return None if publisher is None else self._publishers.setdefault(publisher, len(self._publishers))
