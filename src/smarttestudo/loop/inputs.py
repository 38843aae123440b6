# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Inputs of a loop, live or from a recording. Stamps are the loop's own time."""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from dataclasses import dataclass, field
from typing import Annotated

from smarttestudo.domain.observation import Change, ListenersChanged, SourceChanged
from smarttestudo.domain.profile import Profile
from smarttestudo.domain.record import JsonEntry
from smarttestudo.domain.recording import Channel
from smarttestudo.domain.robot import Payload
from smarttestudo.language.known_types import KnownTypes
from smarttestudo.language.rule_set import RuleSet
from smarttestudo.loop.reload import RuleExchange
from smarttestudo.pacing.sample import WhenSlow


@dataclass(slots=True)
class MessageInput:
    """A message arrived.

    ``message`` is its decoded form, or ``Undecodable``, where a check reads fields of the topic.
    ``publisher`` tells publishers of one topic apart, where that can be told. ``channel`` says how to decode
    it where that is another way than the topic's first. Treat it as immutable; frozen or keyword-only it
    would take two to four times as long to make, and one is made for every message.
    """

    stamp_ns: int
    topic: str
    payload: Payload
    size_bytes: int
    message: object | None = None
    publisher: Hashable = None
    channel: Channel | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class ChangeInput:
    """Publishers of a topic, its listeners, what receivers reckon, budget, clock or vitals changed."""

    stamp_ns: int
    change: Change


@dataclass(frozen=True, slots=True, kw_only=True)
class GraphInput:
    """All that one poll of the graph found, planned for once: no topic gets the part of one that goes too."""

    stamp_ns: int
    sources: tuple[SourceChanged, ...] = ()
    listeners: tuple[ListenersChanged, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class WakeInput:
    """Time passed."""

    stamp_ns: int


@dataclass(frozen=True, slots=True, kw_only=True)
class RulesInput:
    """Other rules and another profile came into force; ``prepared`` may have been made of them beforehand."""

    stamp_ns: int
    rule_set: RuleSet
    profile: Profile
    prepared: RuleExchange | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class RuleTextsInput:
    """How a ``RulesInput`` is recorded, and the rules that a loop started with: by their texts.

    ``rule_texts`` are the rule files by path, ``profile_text`` the profile's TOML, ``names`` the full name
    of each topic in them by the name that they use, ``known`` what they were compiled by of what the robot
    had. For want of valid rules, ``relay_all`` are relayed: at
    ``fallback_hz`` those that are in it, with ``fallback_floors_hz``, and every message of the others.
    """

    stamp_ns: int
    rule_texts: Annotated[Mapping[str, str], JsonEntry(name="rules")]
    profile_text: Annotated[str | None, JsonEntry(name="profile")] = None
    names: Mapping[str, str] = field(default_factory=dict)
    known: Annotated[KnownTypes, JsonEntry(omits_default=True)] = field(default_factory=KnownTypes)
    when_slow: WhenSlow = WhenSlow.PASS
    budget_kb_per_s: float | None = None
    relay_all: tuple[str, ...] | None = None
    fallback_hz: Annotated[Mapping[str, float], JsonEntry(omits_default=True)] = field(default_factory=dict)
    fallback_floors_hz: Annotated[Mapping[str, float], JsonEntry(omits_default=True)] = field(
        default_factory=dict
    )


LoopInput = MessageInput | ChangeInput | GraphInput | WakeInput | RulesInput

RecordedInput = MessageInput | ChangeInput | GraphInput | WakeInput | RuleTextsInput
"""A recorded message has a payload only where a check reads it, nothing decoded, a number as publisher."""
