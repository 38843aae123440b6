# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Which rules are in force in a live run: those of the files, a pushed text, or none."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import AbstractContextManager
from dataclasses import dataclass, replace
from typing import Generic, TypeVar

from smarttestudo.domain.errors import RosError, TestudoError, UsageError
from smarttestudo.domain.parameter import ParameterValue
from smarttestudo.domain.robot import Robot
from smarttestudo.domain.status import RulesInForce, RulesOrigin
from smarttestudo.domain.texts import SayOnce, in_utf_8
from smarttestudo.domain.units import NS_PER_S, counted
from smarttestudo.loop.reload import RuleExchange
from smarttestudo.robot.fallback import FallbackChoice, FallbackTopics
from smarttestudo.robot.live_rules import LARGE_BYTES, LiveRules
from smarttestudo.robot.live_run import POLL_PERIOD_S, LiveRun
from smarttestudo.robot.option import Settings
from smarttestudo.robot.rule_writing import RuleFileWriter
from smarttestudo.robot.rules import PUSHED, CompiledAnew, LiveRuleFiles, Reading, RuleWatch
from smarttestudo.robot.run_options import BUDGET, FALLBACK, RULES_TEXT, STATUS_RATE
from smarttestudo.robot.seen_topics import SeenTopics

CONFIRM_WITHIN_S = 10

_Rules = TypeVar("_Rules")


@dataclass(frozen=True, slots=True)
class _Waiting(Generic[_Rules]):
    """A pushed text that is not confirmed yet, and the rules before it."""

    text_hash: str
    until_ns: int
    before: _Rules


class PushedRules(Generic[_Rules]):
    """A pushed text is in force at once; it is reverted after ``CONFIRM_WITHIN_S`` unless confirmed.

    So rules that disconnect the operator who pushed them do not last. Times are steady.
    """

    def __init__(self, rules: _Rules) -> None:
        self.rules = rules
        self._waiting: _Waiting[_Rules] | None = None
        self._confirmed_hash: str | None = None

    @property
    def is_confirmed(self) -> bool:
        """Whether a pushed text is in force and confirmed."""
        return self._waiting is None and self._confirmed_hash is not None

    @property
    def is_pushed(self) -> bool:
        """Whether a pushed text is in force, confirmed or not."""
        return self._waiting is not None or self._confirmed_hash is not None

    def waits_ns(self, now_ns: int) -> int | None:
        """How long a pushed text still waits to be confirmed; ``None`` if none does."""
        return None if self._waiting is None else max(self._waiting.until_ns - now_ns, 0)

    def replace(self, rules: _Rules) -> None:
        """Put other rules in force; pushed texts from before are forgotten."""
        self.rules = rules
        self._waiting = self._confirmed_hash = None

    def refresh(self, rules: _Rules) -> None:
        """Put ``rules`` in the place of those in force, which have the same text."""
        self.rules = rules

    def push(self, rules: _Rules, text_hash: str, now_ns: int) -> None:
        """Put ``rules`` in force until they are confirmed or time is up; confirmed ones stay confirmed.

        Of texts pushed one after the other without confirmation, the rules before the first come back.
        """
        if text_hash == self._confirmed_hash and self._waiting is None:
            return
        before = self.rules if self._waiting is None else self._waiting.before
        self._waiting = _Waiting(text_hash, now_ns + CONFIRM_WITHIN_S * NS_PER_S, before)
        self.rules = rules

    def is_confirmable(self, text_hash: str) -> bool:
        """Whether ``text_hash`` is that of the text pushed last, waiting or confirmed already."""
        return text_hash == (self._confirmed_hash if self._waiting is None else self._waiting.text_hash)

    def confirm(self, text_hash: str) -> bool:
        """Keep the pushed text; whether it was waiting for that. Another hash changes nothing."""
        if self._waiting is None or self._waiting.text_hash != text_hash:
            return False
        self._waiting, self._confirmed_hash = None, text_hash
        return True

    def roll_back(self, now_ns: int) -> bool:
        """Go back to the rules before the pushed text if it is time; whether it was."""
        if self._waiting is None or now_ns < self._waiting.until_ns:
            return False
        self.rules, self._waiting = self._waiting.before, None
        return True


RELOAD_SERVICE = "~/reload"
FALLBACK_POLL_PERIOD_S = 1.0
_STAYS = "the last valid rules stay in force"


def first_rules(robot: Robot, files: LiveRuleFiles, settings: Settings, fallback: FallbackTopics) -> Reading:
    """The rules at the start; the parameter ``rules_text`` counts if no files are named.

    Raises ``UsageError`` where names of output topics are invalid or taken by other topics, and whatever is
    wrong with the rules where ``--fallback`` says so.
    """
    reading, rules_text = files.read(), settings[RULES_TEXT]
    if files.are_named and rules_text:
        robot.log.warning("rules_text: not used, because rule files are named")
    elif rules_text:
        reading = files.read_text(rules_text)
    if reading.error is not None:
        if settings[FALLBACK] is FallbackChoice.EXIT or isinstance(reading.error, UsageError):
            raise reading.error
        fallback.follow(reading.readable)
        robot.log.warning(f"{reading.error}; {fallback}")
    return reading


class RuleManager:
    """Decides which rules ``live`` follows, and logs changes. It started with those of ``first``."""

    def __init__(
        self,
        robot: Robot,
        live: LiveRun,
        files: LiveRuleFiles,
        fallback: FallbackTopics,
        first: Reading,
        *,
        seen: SeenTopics,
        writer: RuleFileWriter,
    ) -> None:
        self._robot = robot
        self._live = live
        self._files = files
        self._fallback = fallback
        self._seen = seen
        self._writer = writer
        self._warn_once = SayOnce(robot.log.warning)
        self._last = first
        self._loaded = _texts_of_files(first)
        self._in_force = PushedRules(first.rules)
        self._watch = RuleWatch(files, first, live.loop.prepare)
        self._is_asked = False

    def keep(self) -> AbstractContextManager[None]:
        """Follow the rules during the block, as they change."""
        self._warn_of_doubts(self._rules)
        self._show()
        self._live.ask_standing(self._standing)
        self._live.on_graph = self._follow_graph
        self._robot.every(POLL_PERIOD_S, self._poll)
        self._robot.every(FALLBACK_POLL_PERIOD_S, self._poll_topics)
        try:
            self._robot.offer_trigger(RELOAD_SERVICE, self.reload_now)
        except RosError as error:
            self._robot.log.warning(str(error))
        return self._watch.running()

    def accept(self, changes: Mapping[str, ParameterValue]) -> None:
        """Apply newly set parameters, all of them or none. Raises ``TestudoError``."""
        if written := str(changes.get("write_hash", "")).strip().lower():
            self._write(written, is_alone=len(changes) == 1)
            return
        pushed = self._checked_text(str(changes["rules_text"])) if "rules_text" in changes else None
        budget_kb_per_s = _budget(changes)
        status_hz = STATUS_RATE.value(changes["status_hz"]) if "status_hz" in changes else None
        confirmed = str(changes.get("confirm_hash", "")).strip().lower()
        if confirmed and not self._is_confirmable(confirmed, pushed):
            cause = "no pushed rules with this hash wait to be confirmed"
            raise UsageError(cause, place="confirm_hash", remedy="rules_hash is that of the rules in force")
        if budget_kb_per_s is not None:
            self._live.set_budget(budget_kb_per_s)
            self._robot.log.info(f"budget: {budget_kb_per_s:g} KB/s")
        if status_hz is not None:
            self._live.set_status_hz(status_hz)
        if pushed is not None:
            self._push(pushed)
        if self._in_force.confirm(confirmed):
            self._robot.log.info(f"pushed rules confirmed, hash {confirmed}; the files stay as they are")

    def reload_now(self) -> str:
        """Read the files, put them in force and return the outcome. Raises ``TestudoError``."""
        self._is_asked = True
        if self._files.size_bytes() > LARGE_BYTES:
            self._watch.read_soon()
            return "the rules are large and are being checked; the result will be in the log"
        reading = self._files.read()
        self._apply(reading)
        if reading.error is not None:
            raise reading.error
        return f"rules reloaded, hash {self._rules.rules_hash}"

    @property
    def _rules(self) -> LiveRules:
        return self._in_force.rules or self._fallback.rules()

    def _poll(self) -> None:
        for reading in self._watch.readings():
            self._apply(reading)
        for compiled in self._watch.compiled():
            self._take_compiled(compiled)
        if self._in_force.roll_back(self._robot.steady_ns()):
            self._hold()
            rules = self._in_force.rules
            holds = self._fallback if rules is None else f"hash {rules.rules_hash} is in force again"
            self._robot.log.warning(f"pushed rules not confirmed within {CONFIRM_WITHIN_S} s; {holds}")

    def _follow_graph(self) -> None:
        """Compile the rules anew where a topic appeared that they are about, or a type that they name."""
        rules = self._in_force.rules
        if rules is None or not rules.rule_set.is_open or not self._seen.poll():
            return
        self._catch_up()
        if self._in_force.rules is not rules:
            self._live.reload(self._rules)
            self._log_matched(rules)

    def _catch_up(self) -> None:
        """Bring the rules in force up to date with what is known of the robot; large ones soon."""
        rules = self._in_force.rules
        if rules is None or not rules.rule_set.is_open:
            return
        if rules.is_large:
            self._watch.compile_soon(rules)
            return
        try:
            self._in_force.refresh(self._files.up_to_date(rules))
        except TestudoError as error:
            self._warn_once(f"{error}; the rules stay as they are")

    def _take_compiled(self, compiled: CompiledAnew) -> None:
        if compiled.error is not None:
            self._warn_once(f"{compiled.error}; the rules stay as they are")
        if compiled.rules is None or compiled.before is not self._in_force.rules:
            return
        self._in_force.refresh(compiled.rules)
        self._live.reload(compiled.rules, compiled.prepared)
        if compiled.prepared is not None:
            self._watch.free(compiled.prepared)
        self._log_matched(compiled.before)
        # What appeared meanwhile.
        self._watch.compile_soon(compiled.rules)

    def _log_matched(self, before: LiveRules) -> None:
        new = [topic for topic in self._rules.output_topics if topic not in before.output_topics]
        if new:
            others = f" and {counted(len(new) - 1, 'other topic')}" if len(new) > 1 else ""
            self._robot.log.info(f"{new[0]}{others}: there now, and matched by patterns in the rules")

    def _poll_topics(self) -> None:
        if self._in_force.rules is None and self._fallback.poll():
            self._hold()

    def _apply(self, reading: Reading) -> None:
        """Put what was read in force, if it is valid, and new or requested."""
        if reading.number < self._last.number:
            return
        is_new, self._last = reading.content != self._last.content, replace(reading, prepared=None)
        self._loaded = _texts_of_files(reading) or self._loaded
        is_asked, self._is_asked = self._is_asked, False
        if reading.rules is not None and (is_new or is_asked):
            is_other = self._in_force.is_pushed and self._rules.rules_hash != reading.rules.rules_hash
            pushed = "; the pushed rules are no longer in force" if is_other else ""
            self._in_force.replace(reading.rules)
            self._hold(reading.prepared)
            self._robot.log.info(f"rules reloaded, hash {reading.rules.rules_hash}{pushed}")
            self._warn_of_doubts(reading.rules)
        elif reading.error is not None:
            if is_new:
                stays = self._fallback if self._in_force.rules is None else _STAYS
                self._robot.log.warning(f"{reading.error}; {stays}")
            if self._fallback.follow(reading.readable) and self._in_force.rules is None:
                self._hold()

    def _push(self, rules: LiveRules) -> None:
        self._in_force.push(rules, rules.rules_hash, self._robot.steady_ns())
        self._hold()
        self._warn_of_doubts(rules)
        if not self._in_force.is_confirmed:
            self._robot.log.warning(
                f"rules pushed, hash {rules.rules_hash}; they are in force for {CONFIRM_WITHIN_S} s, "
                "and for good if confirm_hash is set to it"
            )

    def _write(self, text_hash: str, *, is_alone: bool) -> None:
        """Write the confirmed rules with this hash to the rule file, and go on with what is there."""
        if not is_alone:
            raise UsageError("it is set together with others", place="write_hash", remedy="set it alone")
        rules = self._in_force.rules
        if rules is None or not self._in_force.is_confirmed or not self._in_force.is_confirmable(text_hash):
            cause = "no pushed and confirmed rules with this hash are in force"
            raise UsageError(cause, place="write_hash", remedy="confirm them first, with confirm_hash")
        self._robot.log.info(self._writer.write(rules.texts[PUSHED], self._loaded))
        self._apply(self._files.read())

    def _hold(self, prepared: RuleExchange | None = None) -> None:
        if (rules := self._in_force.rules) is not None and rules.rule_set.is_open:
            self._seen.poll()
        self._catch_up()
        self._live.reload(self._rules, prepared)
        if prepared is not None:
            self._watch.free(prepared)
        self._show()

    def _warn_of_doubts(self, rules: LiveRules) -> None:
        if rules.doubts:
            self._robot.log.warning(f"{rules.doubts}; testudo check shows all")

    def _show(self) -> None:
        rules = self._rules
        self._robot.show("rules_hash", rules.rules_hash)
        self._robot.show("rules_text", rules.texts.get(PUSHED, ""))
        self._robot.show("rules_in_force", rules.rule_texts.to_text())
        self._robot.show("writable_rules_file", self._writer.file)

    def _standing(self) -> RulesInForce:
        rules, waits_ns = self._rules, self._in_force.waits_ns(self._robot.steady_ns())
        if waits_ns is not None:
            origin = RulesOrigin.WAITING
        elif self._in_force.rules is None:
            origin = RulesOrigin.FALLBACK
        else:
            origin = RulesOrigin.PUSHED if PUSHED in rules.texts else RulesOrigin.FILES
        waits_s = None if waits_ns is None else waits_ns / NS_PER_S
        error = self._last.error if self._files.are_named else None
        problem = None if error is None else in_utf_8(str(error))
        fallback = self._fallback.relays if origin is RulesOrigin.FALLBACK else None
        return replace(rules.in_force, origin=origin, waits_s=waits_s, problem=problem, fallback=fallback)

    def _checked_text(self, text: str) -> LiveRules:
        size_bytes = len(text.encode("utf-8"))
        if size_bytes > LARGE_BYTES:
            cause = f"{size_bytes} bytes are too many to check while messages are waiting"
            raise UsageError(cause, place=PUSHED, remedy="put the rules into a rule file")
        return self._files.check(text)

    def _is_confirmable(self, text_hash: str, pushed: LiveRules | None) -> bool:
        if pushed is not None:
            return pushed.rules_hash == text_hash
        return self._in_force.is_confirmable(text_hash)


def _texts_of_files(reading: Reading) -> Mapping[str, str]:
    """The texts that valid rules were read from by path; none where it is no reading of files."""
    texts = {} if reading.rules is None else reading.rules.texts
    return {path: text for path, text in texts.items() if path != PUSHED}


def _budget(changes: Mapping[str, ParameterValue]) -> float | None:
    if "budget_kb_per_s" not in changes:
        return None
    number = BUDGET.value(changes["budget_kb_per_s"])
    if number is None:
        raise UsageError("a budget cannot be unset", place="budget_kb_per_s", remedy="set a large one")
    return number
