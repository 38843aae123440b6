# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The rules of a live run: read from files, checked, and read again when they change."""

from __future__ import annotations

import threading
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from itertools import count
from pathlib import Path
from queue import Empty, SimpleQueue

from smarttestudo.domain.errors import RuleFileError, TestudoError, said, testudo_error
from smarttestudo.domain.profile import Profile
from smarttestudo.domain.rule_texts import RuleTexts
from smarttestudo.domain.status import RulesInForce
from smarttestudo.files.toml_text import read_toml_text
from smarttestudo.language.normal_form import Resolve
from smarttestudo.language.rule_set import RuleSet
from smarttestudo.robot.output_topics import OutputTopic, output_topics
from smarttestudo.rules.profile_file import parse_profile
from smarttestudo.rules.rule_files import (
    FileStates,
    file_states,
    find_rule_files,
    read_rule_text,
    total_bytes,
)
from smarttestudo.rules.rule_sets import check_texts

PUSHED = "rules_text"


@dataclass(frozen=True, slots=True, kw_only=True)
class LiveRules:
    """Valid rules: their meaning, and their texts by path.

    ``output_topics`` has the output topic of each relayed one, ``names`` the full name of each topic by the
    name that the texts use.
    """

    rule_set: RuleSet
    output_topics: Mapping[str, str]
    profile: Profile = field(default_factory=Profile)
    in_force: RulesInForce = field(default_factory=RulesInForce)
    texts: Mapping[str, str] = field(default_factory=dict)
    profile_text: str | None = None
    names: Mapping[str, str] = field(default_factory=dict)

    @property
    def rules_hash(self) -> str:
        """The SHA-256 of the rule texts, one after the other; empty while there are none."""
        return self.in_force.sha256

    @property
    def rule_texts(self) -> RuleTexts:
        """The texts of the rules in force, for the node's parameter."""
        renamed = {name: full for name, full in self.names.items() if name != full}
        return RuleTexts(sha256=self.rules_hash, files=tuple(self.texts.items()), full_names=renamed)


@dataclass(frozen=True, slots=True, kw_only=True)
class Reading:
    """The result of reading the files: rules, or their first error.

    Of two readings the one with the greater ``number`` began later; equal ``content`` was equal text.
    ``states`` are older than what was read.
    """

    number: int
    states: FileStates
    content: str
    rules: LiveRules | None = None
    error: TestudoError | None = None


class LiveRuleFiles:
    """The rule files and the profile of a live run; several threads may read at a time."""

    def __init__(
        self, rules: Sequence[Path], profile: Path | None, *, resolve: Resolve, output_topic: OutputTopic
    ) -> None:
        self._rules = rules
        self._profile = profile
        self._resolve = resolve
        self._output_topic = output_topic
        self._numbers = count()

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
            content = repr((texts, profile_text))
            rules = self._checked(texts, profile_text)
            return Reading(number=number, states=states, content=content, rules=rules)
        except Exception as error:  # noqa: BLE001 - a thread reads them, which must not end
            return Reading(
                number=number, states=states, content=content or said(error), error=testudo_error(error)
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
            return Reading(number=number, states=states, content=text, error=error)

    def check(self, text: str) -> LiveRules:
        """The rules of a text beside the profile as it is now. Raises ``TestudoError``."""
        return self._checked({PUSHED: text}, self._profile_text())

    def _texts(self) -> tuple[dict[str, str], str | None]:
        if not self._rules:
            raise RuleFileError("no rules are given", remedy="name a rule file with --rules")
        texts = {str(path): read_rule_text(path) for path in find_rule_files(self._rules)}
        return texts, self._profile_text()

    def _profile_text(self) -> str | None:
        return None if self._profile is None else read_toml_text(self._profile)

    def _checked(self, texts: Mapping[str, str], profile_text: str | None) -> LiveRules:
        names: dict[str, str] = {}

        def resolve(topic: str) -> str:
            return names.setdefault(topic, self._resolve(topic))

        profile = None
        if self._profile is not None and profile_text is not None:
            profile = parse_profile(profile_text, self._profile).resolved(resolve)
        loaded = check_texts(texts, profile=profile, resolve=resolve)
        loaded.refuse_errors()
        return LiveRules(
            rule_set=loaded.rule_set,
            output_topics=output_topics(loaded.rule_set, self._output_topic),
            profile=profile or Profile(),
            in_force=loaded.in_force,
            texts=texts,
            profile_text=profile_text,
            names=names,
        )


LOOK_PERIOD_S = 0.25


class RuleWatch:
    """Looks at the files every ``LOOK_PERIOD_S`` and reads them once a change has been there for two looks.

    ``last`` was read before.
    So a file that an editor empties and then writes is rarely read halfway.
    """

    def __init__(self, files: LiveRuleFiles, last: Reading) -> None:
        self._files = files
        self._readings: SimpleQueue[Reading] = SimpleQueue()
        self._ended = threading.Event()
        self._read: FileStates | None = last.states
        self._seen = self._read

    def read_soon(self) -> None:
        """Read the files at the next look, changed or not."""
        self._read = None

    def take(self) -> Iterator[Reading]:
        """Readings since the last call, in order."""
        with suppress(Empty):
            while True:
                yield self._readings.get_nowait()

    @contextmanager
    def running(self) -> Iterator[None]:
        """Watch during the block."""
        thread = threading.Thread(target=self._watch, name="rule files", daemon=True)
        thread.start()
        try:
            yield
        finally:
            self._ended.set()
            thread.join()

    def _watch(self) -> None:
        while not self._ended.wait(LOOK_PERIOD_S):
            if self._is_to_be_read():
                self._readings.put(self._files.read())

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
