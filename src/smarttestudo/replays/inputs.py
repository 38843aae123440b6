# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The inputs of a live loop, given to another one."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from smarttestudo.bags.definitions import RosbagDecoder
from smarttestudo.domain.decision import AnyDecision
from smarttestudo.domain.errors import RecordingError
from smarttestudo.domain.names import resolve_topic
from smarttestudo.domain.observation import SourceChanged, Undecodable
from smarttestudo.domain.profile import Profile
from smarttestudo.domain.rate import Rate
from smarttestudo.domain.recording import Channel
from smarttestudo.domain.units import LAST_STAMP_NS, NS_PER_S, counted
from smarttestudo.language.rule_set import RuleSet, fallback_rules
from smarttestudo.loop.input_log import read_inputs
from smarttestudo.loop.inputs import (
    ChangeInput,
    GraphInput,
    LoopInput,
    MessageInput,
    RecordedInput,
    RulesInput,
    RuleTextsInput,
)
from smarttestudo.loop.relay_loop import RelayLoop
from smarttestudo.rules.profile_file import parse_profile
from smarttestudo.rules.rule_sets import check_texts


@dataclass(frozen=True, slots=True, kw_only=True)
class InputsOutcome:
    """How much a loop was given over which time, how often it decided, and what was odd, a line each."""

    inputs: int
    decisions: int
    duration_s: float
    notices: tuple[str, ...]

    def rows(self) -> Iterator[dict[str, object]]:
        """No rows: inputs are not relayed."""
        return iter(())


def replay_inputs(
    folder: Path,
    decided: Callable[[Sequence[AnyDecision]], None],
    *,
    until_ns: int = LAST_STAMP_NS,
    ended: Callable[[int, RelayLoop], None] | None = None,
) -> InputsOutcome:
    """Give a new loop the inputs recorded in ``folder``, and ``decided`` its decisions, in order.

    It ends at ``until_ns``, if that is before the last input, and ``ended`` is shown the time and the loop.

    Raises:
        RecordingError: there is no such recording, or a line of it is no input.
        RuleFileError: its rules have errors, which those of a live run never had.
    """
    cuts: list[str] = []
    inputs = read_inputs(folder, cuts.append)
    first = next(inputs, None)
    if not isinstance(first, RuleTextsInput):
        raise RecordingError("the recorded inputs do not start with rules", place=str(folder))
    again = _Again(first)
    decided(again.take_decisions())
    for recorded in inputs:
        if recorded.stamp_ns > until_ns:
            again.now_ns = until_ns
            break
        again.on_input(recorded)
        decided(again.take_decisions())
    if ended is not None:
        ended(again.now_ns, again.loop)
    return InputsOutcome(
        inputs=again.inputs,
        decisions=again.decisions,
        duration_s=(again.now_ns - first.stamp_ns) / NS_PER_S,
        notices=(*again.notices(), *cuts),
    )


class _Again:
    """A loop that takes recorded inputs."""

    def __init__(self, first: RuleTextsInput) -> None:
        rules, profile = _rules(first)
        self.loop = RelayLoop(rules, profile, first.stamp_ns, first.when_slow, first.budget_kb_per_s)
        self.now_ns = first.stamp_ns
        self.inputs = 1
        self.decisions = 0
        self._decoder = RosbagDecoder()
        self._channels: dict[str, Channel] = {}

    def take_decisions(self) -> list[AnyDecision]:
        """Decisions since the last call."""
        decisions = self.loop.take_all_decisions()
        self.decisions += len(decisions)
        return decisions

    def on_input(self, recorded: RecordedInput) -> None:
        """Give it to the loop; what would be relayed went out in the live run."""
        self.now_ns = recorded.stamp_ns
        self.inputs += 1
        self.loop.handle(self._given(recorded))

    def notices(self) -> Iterator[str]:
        """Oddities, one line each."""
        for topic, count in self.loop.knowledge.undecodable.items():
            yield f"{topic}: {counted(count, 'message')} could not be decoded; what checks read was unknown"

    def _given(self, recorded: RecordedInput) -> LoopInput:
        """Input that the loop of the live run was given."""
        match recorded:
            case MessageInput(topic=topic) if self.loop.knowledge.reads(topic):
                return replace(recorded, message=self._message(recorded))
            case ChangeInput(change=SourceChanged() as source):
                self._note_sources([source])
            case GraphInput(sources=sources):
                self._note_sources(sources)
            case RuleTextsInput(stamp_ns=now_ns):
                rule_set, profile = _rules(recorded)
                return RulesInput(stamp_ns=now_ns, rule_set=rule_set, profile=profile)
        return recorded

    def _note_sources(self, sources: Iterable[SourceChanged]) -> None:
        for source in sources:
            self._channels[source.topic] = Channel(topic=source.topic, type_name=source.type_name)

    def _message(self, recorded: MessageInput) -> object:
        channel, payload = self._channels.get(recorded.topic), recorded.payload[:]
        if channel is None or not payload:
            return Undecodable()
        try:
            return self._decoder.decode(channel, payload)
        except RecordingError:
            return Undecodable()


def _rules(given: RuleTextsInput) -> tuple[RuleSet, Profile]:
    """Rules and profile that came into force."""
    if given.relay_all is not None:
        rates = {topic: Rate(given.fallback_hz.get(topic, math.inf)) for topic in given.relay_all}
        return fallback_rules(rates, given.fallback_floors_hz), Profile()

    def resolve(topic: str) -> str:
        return given.names.get(topic) or resolve_topic(topic)

    profile = Profile()
    if given.profile_text is not None:
        profile = parse_profile(given.profile_text, Path("profile")).resolved(resolve)
    loaded = check_texts(given.rule_texts, profile=profile, resolve=resolve)
    loaded.refuse_errors()
    return loaded.rule_set.by(given.known), profile
