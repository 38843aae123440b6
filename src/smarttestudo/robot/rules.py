# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The rules of a live run: read from files, checked, and read again when they change."""

from __future__ import annotations

import hashlib
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, nullcontext, suppress
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import count
from pathlib import Path
from queue import Empty, SimpleQueue

from smarttestudo.domain.errors import RuleFileError, TestudoError, said, testudo_error
from smarttestudo.domain.timing import Yield
from smarttestudo.language.known_types import KnownTypes
from smarttestudo.language.normal_form import Resolve
from smarttestudo.language.rule_set import RuleSet
from smarttestudo.loop.reload import RuleExchange
from smarttestudo.robot.fallback import ReadableRates, readable_rates
from smarttestudo.robot.live_rules import LiveRules, are_large, check_live_rules
from smarttestudo.robot.low_priority import low_priority
from smarttestudo.robot.output_topics import OutputTopic, output_topics
from smarttestudo.rules.rule_files import (
    FileStates,
    file_states,
    find_rule_files,
    read_rule_text,
    readable_texts,
    total_bytes,
)

PUSHED = "rules_text"


@dataclass(frozen=True, slots=True, kw_only=True)
class CompiledAnew:
    """The rules ``before``, compiled with what is known now, or why they were not."""

    before: LiveRules
    rules: LiveRules | None = None
    error: TestudoError | None = None
    prepared: RuleExchange | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Reading:
    """The result of reading the files: rules, or their first error.

    Of two readings the one with the greater ``number`` began later; equal ``content`` was equal text.
    ``states`` are older than what was read. ``prepared`` may have been made of the rules; where there is an
    error, ``readable`` is what can be read of them all the same, if that is asked for.
    """

    number: int
    states: FileStates
    content: str
    rules: LiveRules | None = None
    error: TestudoError | None = None
    prepared: RuleExchange | None = None
    readable: ReadableRates = field(default_factory=ReadableRates)


class LiveRuleFiles:
    """The rule files and the profile of a live run; several threads may read at a time.

    ``known`` is what is known of the robot, for rules that depend on it.
    ``reads_broken``: a reading with an error has the rates that can be read all the same.
    """

    def __init__(
        self,
        rules: Sequence[Path],
        profile: Path | None,
        *,
        resolve: Resolve,
        output_topic: OutputTopic,
        known: Callable[[], KnownTypes] = KnownTypes,
        reads_broken: bool = False,
    ) -> None:
        self._rules = rules
        self._profile = profile
        self._resolve = resolve
        self._output_topic = output_topic
        self._known = known
        self._reads_broken = reads_broken
        self._numbers = count()
        self._ended = threading.Event()

    def close(self) -> None:
        """Check nothing to the end that takes long."""
        self._ended.set()

    def states(self) -> FileStates:
        """State of the files, which changes when one of them does."""
        return file_states([*self._rules, *([] if self._profile is None else [self._profile])])

    def size_bytes(self) -> int:
        """How much there is to read."""
        return total_bytes(self.states())

    def read(self) -> Reading:
        """The files as they are now; whatever goes wrong is the error of the reading."""
        number, states, content = next(self._numbers), FileStates(), ""
        try:
            states = self.states()
            texts, profile_text = self._texts()
            content = hashlib.sha256(repr((texts, profile_text)).encode()).hexdigest()
            rules = self._checked(texts, profile_text)
            # From now on the last valid ones stay in force.
            self._reads_broken = False
            return Reading(number=number, states=states, content=content, rules=rules)
        except Exception as error:  # noqa: BLE001 - a thread reads them, which must not end
            return Reading(
                number=number,
                states=states,
                content=content or said(error),
                error=testudo_error(error),
                readable=self._readable(readable_texts(self._rules)),
            )

    @property
    def are_named(self) -> bool:
        """Whether there are files to read at all."""
        return bool(self._rules)

    def read_text(self, text: str) -> Reading:
        """Like ``read``, for a text in place of the rule files."""
        number, states = next(self._numbers), self.states()
        try:
            return Reading(number=number, states=states, content=text, rules=self.check(text))
        except TestudoError as error:
            readable = self._readable({PUSHED: text})
            return Reading(number=number, states=states, content=text, error=error, readable=readable)

    def check(self, text: str) -> LiveRules:
        """The rules of a text beside the profile as it is now. Raises ``TestudoError``."""
        return self._checked({PUSHED: text}, self._profile_text())

    def _readable(self, texts: Mapping[str, str]) -> ReadableRates:
        if not self._reads_broken:
            return ReadableRates()
        with low_priority() if are_large(texts) else nullcontext():
            return readable_rates(texts, self._resolve)

    def _texts(self) -> tuple[dict[str, str], str | None]:
        if not self._rules:
            raise RuleFileError("no rules are given", remedy="name a rule file with --rules")
        texts = {str(path): read_rule_text(path) for path in find_rule_files(self._rules)}
        return texts, self._profile_text()

    def _profile_text(self) -> str | None:
        if self._profile is None:
            return None
        from smarttestudo.files.toml_text import read_toml_text  # noqa: PLC0415  it loads a parser of TOML

        return read_toml_text(self._profile)

    def up_to_date(self, rules: LiveRules) -> LiveRules:
        """``rules`` as they are by what is known of the robot now, the same if that changes nothing.

        Raises ``TestudoError``.
        """
        rule_set = rules.rule_set
        if not rule_set.is_open:
            return rules
        known = self._known().needed(rule_set.patterns, rule_set.typed)
        if known == rules.known:
            return rules
        if rule_set.anew is not None:
            return self._with_outputs(replace(rules, rule_set=rule_set.by(known), known=known))
        return self._compiled(rules.texts, rules.profile_text, known)

    def _checked(self, texts: Mapping[str, str], profile_text: str | None) -> LiveRules:
        return self.up_to_date(self._compiled(texts, profile_text, KnownTypes()))

    def _compiled(self, texts: Mapping[str, str], profile_text: str | None, known: KnownTypes) -> LiveRules:
        check = partial(check_live_rules, texts, self._profile, profile_text, known=known)
        if are_large(texts):
            from smarttestudo.robot.rule_checking import check_elsewhere  # noqa: PLC0415  few rules are large

            return self._with_outputs(check_elsewhere(check, self._resolve, self._ended.is_set))
        return self._with_outputs(check(self._resolve))

    def _with_outputs(self, rules: LiveRules) -> LiveRules:
        return replace(rules, output_topics=output_topics(rules.rule_set, self._output_topic))


POLL_PERIOD_S = 0.25


class RuleWatch:
    """Polls the files every ``POLL_PERIOD_S`` and reads them once a change has been there for two polls.

    ``last`` was read before. ``prepare`` is called for large rules that are valid.
    So a file that an editor empties and then writes is rarely read halfway.
    """

    def __init__(
        self, files: LiveRuleFiles, last: Reading, prepare: Callable[[RuleSet, Yield], RuleExchange]
    ) -> None:
        self._files = files
        self._prepare = prepare
        self._replaced: SimpleQueue[RuleExchange] = SimpleQueue()
        self._readings: SimpleQueue[Reading] = SimpleQueue()
        self._to_compile: LiveRules | None = None
        self._compiled: SimpleQueue[CompiledAnew] = SimpleQueue()
        self._ended = threading.Event()
        self._read: FileStates | None = last.states
        self._seen = self._read

    def read_soon(self) -> None:
        """Read the files at the next poll, changed or not."""
        self._read = None

    def readings(self) -> Iterator[Reading]:
        """Readings since the last call, in order."""
        with suppress(Empty):
            while True:
                yield self._readings.get_nowait()

    def compile_soon(self, rules: LiveRules) -> None:
        """Compile large rules anew at the next poll, by what is known then."""
        self._to_compile = rules

    def compiled(self) -> Iterator[CompiledAnew]:
        """Rules that were compiled anew since the last call, where that changed anything."""
        with suppress(Empty):
            while True:
                yield self._compiled.get_nowait()

    def free(self, replaced: RuleExchange) -> None:
        """Have the rules freed in the place of which ``replaced`` came into force."""
        self._replaced.put(replaced)

    @contextmanager
    def running(self) -> Iterator[None]:
        """Watch during the block."""
        thread = threading.Thread(target=self._watch, name="rule files", daemon=True)
        thread.start()
        try:
            yield
        finally:
            self._ended.set()
            self._files.close()
            thread.join()

    def _watch(self) -> None:
        while not self._ended.wait(POLL_PERIOD_S):
            with suppress(Empty):
                replaced = self._replaced.get_nowait()
                with low_priority() as yield_turn:
                    replaced.dismantle(yield_turn)
                    del replaced
            if self._is_to_be_read():
                reading = self._files.read()
                self._readings.put(replace(reading, prepared=self._prepared(reading.rules)))
            if (rules := self._to_compile) is not None:
                self._to_compile = None
                self._compile(rules)

    def _compile(self, before: LiveRules) -> None:
        try:
            rules = self._files.up_to_date(before)
        except Exception as error:  # noqa: BLE001 - as of a reading
            self._compiled.put(CompiledAnew(before=before, error=testudo_error(error)))
            return
        if rules is not before:
            self._compiled.put(CompiledAnew(before=before, rules=rules, prepared=self._prepared(rules)))

    def _prepared(self, rules: LiveRules | None) -> RuleExchange | None:
        if rules is None or not rules.is_large:
            return None
        with low_priority() as yield_turn:
            return self._prepare(rules.rule_set, yield_turn)

    def _is_to_be_read(self) -> bool:
        try:
            return self._has_settled(self._files.states())
        except Exception:  # noqa: BLE001 - the thread continues; the reading has the error
            return True

    def _has_settled(self, now: FileStates) -> bool:
        before, self._seen = self._seen, now
        if now == self._read or now != before:
            return False
        self._read = now
        return True
