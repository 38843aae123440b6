# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The inputs of a live loop, given to another one."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from smarttestudo.adapters.files.input_log import read_inputs
from smarttestudo.adapters.files.profile import parse_profile
from smarttestudo.adapters.rosbag import RosbagDecoder
from smarttestudo.adirf.rule_set import RuleSet, fallback_rules
from smarttestudo.composition.replay_topics import counted
from smarttestudo.composition.rule_sets import check_texts
from smarttestudo.domain.decision import Decision
from smarttestudo.domain.errors import RecordingError, RuleFileError
from smarttestudo.domain.names import resolve_topic
from smarttestudo.domain.observation import LinkBudget, Undecodable
from smarttestudo.domain.profile import Profile
from smarttestudo.domain.recording import Channel
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.runtime.inputs import (
    BudgetInput,
    LoopInput,
    MessageInput,
    RulesInput,
    SourceInput,
    WakeInput,
)
from smarttestudo.runtime.relay_loop import RelayLoop


@dataclass(frozen=True, slots=True, kw_only=True)
class InputsOutcome:
    """How much a loop was given over which time, how often it decided, and what was odd, a line each."""

    inputs: int
    decisions: int
    duration_s: float
    notices: tuple[str, ...]

    def to_json(self) -> dict[str, object]:
        """The object that ``testudo replay --json`` prints."""
        return asdict(self)


def replay_inputs(folder: Path, decided: Callable[[Sequence[Decision]], None]) -> InputsOutcome:
    """Give a new loop the inputs recorded in ``folder``, and ``decided`` its decisions, in order.

    Raises:
        RecordingError: there is no such recording, or a line of it is no input.
        RuleFileError: its rules have errors, which those of a live run never had.
    """
    inputs = read_inputs(folder)
    first = next(inputs, None)
    if not isinstance(first, RulesInput):
        raise RecordingError("the recorded inputs do not start with rules", place=str(folder))
    again = _Again(first)
    decided(again.take_decisions())
    for given in inputs:
        again.take(given)
        decided(again.take_decisions())
    return InputsOutcome(
        inputs=again.inputs,
        decisions=again.decisions,
        duration_s=(again.now_ns - first.stamp_ns) / NS_PER_S,
        notices=tuple(again.notices()),
    )


class _Again:
    """A loop that takes recorded inputs."""

    def __init__(self, first: RulesInput) -> None:
        rules, profile = _rules(first)
        self.loop = RelayLoop(rules, profile, first.stamp_ns, first.when_slow, first.budget_kb_per_s)
        self.now_ns = first.stamp_ns
        self.inputs = 1
        self.decisions = 0
        self._decoder = RosbagDecoder()
        self._channels: dict[str, Channel] = {}

    def take_decisions(self) -> list[Decision]:
        """Those since the last call."""
        decisions = self.loop.take_decisions()
        self.decisions += len(decisions)
        return decisions

    def take(self, given: LoopInput) -> None:
        """Give it to the loop; what would be relayed went out in the live run."""
        loop, self.now_ns = self.loop, given.stamp_ns
        self.inputs += 1
        match given:
            case MessageInput(stamp_ns=now_ns, topic=topic, size_bytes=size_bytes):
                message = self._message(given) if loop.reads(topic) else None
                payload = given.payload or b""
                loop.on_message(
                    topic, now_ns, payload, size_bytes, message=message, publisher=given.publisher
                )
            case WakeInput(stamp_ns=now_ns):
                loop.on_wake(now_ns)
            case SourceInput(stamp_ns=now_ns, change=change):
                self._channels[change.topic] = Channel(topic=change.topic, type_name=change.type_name)
                loop.on_source(change, now_ns)
            case BudgetInput(stamp_ns=now_ns, budget_kb_per_s=budget_kb_per_s):
                loop.on_budget(LinkBudget(link_kb_per_s=budget_kb_per_s), now_ns)
            case RulesInput(stamp_ns=now_ns):
                loop.reload(*_rules(given), now_ns)

    def notices(self) -> Iterator[str]:
        """What was odd, one line each."""
        for topic, count in self.loop.undecodable.items():
            yield f"{topic}: {counted(count, 'message')} could not be decoded; what checks read was unknown"

    def _message(self, given: MessageInput) -> object:
        channel = self._channels.get(given.topic)
        if channel is None or given.payload is None:
            return Undecodable()
        try:
            return self._decoder.decode(channel, given.payload)
        except RecordingError:
            return Undecodable()


def _rules(given: RulesInput) -> tuple[RuleSet, Profile]:
    """What came into force."""
    if given.relay_all is not None:
        return fallback_rules(given.relay_all), Profile()

    def resolve(topic: str) -> str:
        return given.names.get(topic) or resolve_topic(topic)

    profile = Profile()
    if given.profile_text is not None:
        profile = parse_profile(given.profile_text, Path("profile")).resolved(resolve)
    loaded = check_texts(given.rule_texts, profile=profile, resolve=resolve)
    if loaded.errors:
        first = loaded.errors[0]
        raise RuleFileError(first.message, place=str(first.span))
    return loaded.rule_set, profile
