# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Relayed topics while there are no valid rules: everything, at rates that suit where it goes."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from enum import Enum
from typing import TypeVar

from smarttestudo.domain.errors import TestudoError, UsageError
from smarttestudo.domain.names import is_output_name
from smarttestudo.domain.rate import MAX_RATE_HZ, Rate
from smarttestudo.domain.robot import Robot, is_visible
from smarttestudo.domain.status import Fallback
from smarttestudo.language.normal_form import Resolve
from smarttestudo.language.parser import parse
from smarttestudo.language.rule_set import fallback_rules
from smarttestudo.language.syntax import KeepAtLeast, SetFrequency
from smarttestudo.language.topic_pattern import ONE_NAME, matching, standing
from smarttestudo.pacing.sample import is_patch
from smarttestudo.robot.live_rules import LiveRules
from smarttestudo.robot.output_topics import OutputTopic, output_topics
from smarttestudo.robot.seen_topics import SeenTopics

_Value = TypeVar("_Value")
# Time has to come from one place.
_CLOCK_TOPIC = "/clock"
LEAST_HZ = 1.0
"""The rate of a topic that goes out by rules with errors, unless a higher one can be read of them."""


class FallbackChoice(Enum):
    """Choice of the user for the time without valid rules; the value is its spelling."""

    AUTO = "auto"
    """``READABLE`` where what is relayed leaves the robot's graph and rules were given, else ``FULL``."""
    FULL = "full"
    OFF = "off"
    EXIT = "exit"
    """Refuse to start."""

    def what_is_relayed(self, *, leaves_graph: bool, has_rules: bool) -> Fallback:
        """Its meaning for a run; ``has_rules``: some were given, valid or not."""
        if self is FallbackChoice.OFF:
            return Fallback.OFF
        is_auto = self is FallbackChoice.AUTO
        return Fallback.READABLE if is_auto and leaves_graph and has_rules else Fallback.FULL


@dataclass(frozen=True, slots=True, kw_only=True)
class ReadableRates:
    """The defaults and floors of rules with errors, by full name or pattern; levels cannot be read."""

    defaults: Mapping[str, Rate] = field(default_factory=dict)
    floors_hz: Mapping[str, float] = field(default_factory=dict)

    def rate(self, topic: str, *, is_patch: bool = False) -> Rate:
        """The rate of ``topic``, at least ``LEAST_HZ``; patches are only thinned where a rate is written."""
        unwritten = Rate.full() if is_patch else Rate(LEAST_HZ)
        default = _of_topic(self.defaults, topic)
        return max(unwritten if default is None else default, Rate(self.floor_hz(topic)), Rate(LEAST_HZ))

    def floor_hz(self, topic: str) -> float:
        """The floor of ``topic``, 0 without one."""
        return _of_topic(self.floors_hz, topic) or 0.0


def _of_topic(written: Mapping[str, _Value], topic: str) -> _Value | None:
    """The value of the name or pattern that counts for ``topic``."""
    names = [name for name in written if name == topic or (ONE_NAME in name and matching(name, [topic]))]
    return written[max(names, key=standing)] if names else None


def readable_rates(texts: Mapping[str, str], resolve: Resolve) -> ReadableRates:
    """The rates that the parser can read of rule texts by path, whatever else is wrong with them.

    Of several defaults of a topic the lowest counts: what follows a broken block may have been part of it.
    """
    defaults: dict[str, Rate] = {}
    floors_hz: dict[str, float] = {}
    for path, text in texts.items():
        for statement in parse(text, path).file.enabled_statements:
            if not isinstance(statement, SetFrequency | KeepAtLeast):
                continue
            rate = statement.highest.rate if isinstance(statement, SetFrequency) else statement.rate.rate
            if rate is None or not (rate.is_full or 0 <= rate.hz <= MAX_RATE_HZ):
                continue
            with suppress(TestudoError):
                topic = resolve(statement.topic.text)
                if isinstance(statement, SetFrequency):
                    defaults[topic] = min(rate, defaults.get(topic, rate))
                else:
                    floors_hz[topic] = max(rate.hz, floors_hz.get(topic, 0.0))
    return ReadableRates(defaults=defaults, floors_hz=floors_hz)


class FallbackTopics:
    """The topics of a robot that its own nodes publish, below ``topic_prefix``; once seen, they stay.

    Hidden topics, those of every node, the clock and what SmartTestudo nodes publish are left out, and with
    a warning those for which ``output_topic`` makes no name of their own; ``UsageError`` where it never does.
    """

    def __init__(
        self, robot: Robot, *, output_topic: OutputTopic, topic_prefix: str, relays: Fallback = Fallback.FULL
    ) -> None:
        self.relays = relays
        self._robot = robot
        self._output_topic = output_topic
        self._topic_prefix = topic_prefix
        self._readable = ReadableRates()
        self._output_topics: dict[str, str] = {}
        self._seen = SeenTopics(robot, self._may_join)
        self._refused: set[str] = set()
        output_topics(fallback_rules({"/any": Rate.full()}), output_topic)

    def follow(self, readable: ReadableRates) -> bool:
        """Relay at these rates from now on, where rates count that can be read; whether that changes any."""
        before, self._readable = self._readable, readable
        return self.relays is Fallback.READABLE and before != readable

    def poll(self) -> bool:
        """Whether the topics are others than at the last poll."""
        if self.relays is Fallback.OFF:
            return False
        if not self._seen.poll():
            return False
        before = dict(self._output_topics)
        for topic in before.keys() - self._seen.types.keys():
            del self._output_topics[topic]
        for topic in sorted(self._seen.types.keys() - before.keys() - self._refused):
            self._join(topic)
        return self._output_topics != before

    def rules(self) -> LiveRules:
        """All of them at their rates."""
        topics, readable = dict(self._output_topics), self._readable
        if self.relays is not Fallback.READABLE:
            return LiveRules(
                rule_set=fallback_rules(dict.fromkeys(topics, Rate.full())), output_topics=topics
            )
        types = self._robot.topics()
        rates = {
            topic: readable.rate(topic, is_patch=any(map(is_patch, types.get(topic, ())))) for topic in topics
        }
        floors_hz = {topic: hz for topic in topics if (hz := readable.floor_hz(topic))}
        return LiveRules(rule_set=fallback_rules(rates, floors_hz), output_topics=topics)

    def __str__(self) -> str:
        """The state, for the log."""
        match self.relays:
            case Fallback.OFF:
                return "relaying nothing until there are rules"
            case Fallback.FULL:
                return "relaying everything at Full until there are rules"
            case Fallback.READABLE:
                here = "" if self._output_topic.is_elsewhere else ", on this robot's graph as over the link"
                return (
                    f"until there are rules, defaults and floors that can be read count, none below "
                    f"{LEAST_HZ:g} Hz, updates of maps and scenes are at Full, and all other topics have "
                    f"{LEAST_HZ:g} Hz{here}"
                )

    def _join(self, topic: str) -> None:
        try:
            in_use = self._output_topics.values()
            alone = fallback_rules({topic: Rate.full()})
            self._output_topics.update(output_topics(alone, self._output_topic, in_use=in_use))
        except UsageError as error:
            self._refused.add(topic)
            self._robot.log.warning(str(error))

    def _may_join(self, topic: str) -> bool:
        return not (
            topic in self._refused
            or topic == _CLOCK_TOPIC
            or not is_visible(topic)
            or is_output_name(topic, self._output_topic.pattern)
            or not topic.startswith(f"{self._topic_prefix}/")
        )
