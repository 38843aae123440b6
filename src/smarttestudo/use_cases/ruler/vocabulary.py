# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The topics and properties to suggest while rules are written."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from enum import Enum
from pathlib import Path

from msgspec import Struct

from smarttestudo.adapters.files.profile import parse_profile
from smarttestudo.adirf.parser import ParseResult, parse
from smarttestudo.adirf.properties import (
    ARRIVAL_PROPERTIES,
    PropertySpec,
    properties_for_bounds,
    properties_of,
    usual_types,
)
from smarttestudo.adirf.syntax import Block, bounds_in, checks_in, records_in, sets_in
from smarttestudo.domain.profile import Profile


class TopicSource(Enum):
    """Who names a topic; the value is its name in JSON, the order that of trust."""

    PROFILE = "profile"
    ROBOT = "robot"
    RULES = "rules"
    EXAMPLE = "example"


class Property(Struct, frozen=True, kw_only=True):
    """A property that a check can read or a bound can be about."""

    name: str
    unit: str
    meaning: str


class KnownTopic(Struct, frozen=True, kw_only=True):
    """A topic, its type where anybody knows it, else the one that its name stands for, and who names it.

    ``properties`` are those that checks read, ``bounds`` those that only a ``KeepWithin`` can name.
    """

    topic: str
    type: str | None
    properties: tuple[Property, ...]
    bounds: tuple[Property, ...]
    source: TopicSource


class VocabularyRequest(Struct, frozen=True, kw_only=True):
    """``POST /api/vocabulary`` → ``Vocabulary``."""

    text: str | None = None
    profile_text: str | None = None


class Vocabulary(Struct, frozen=True, kw_only=True):
    """What an editor suggests; ``every_topic`` are the properties of any topic."""

    topics: tuple[KnownTopic, ...]
    every_topic: tuple[Property, ...]


_EXAMPLE_TOPICS = (
    *("/odom", "/cmd_vel", "/scan", "/battery_state", "/imu", "/joint_states", "/tf"),
    *("/camera/camera_info", "/camera/image_raw", "/camera/image_raw/compressed"),
)
"""The topics of a TurtleBot3."""


def vocabulary(request: VocabularyRequest, robot_topics: Mapping[str, str]) -> Vocabulary:
    """Words to suggest; ``robot_topics`` are the types of what is live now."""
    profile_text = request.profile_text
    profile = None if profile_text is None else parse_profile(profile_text, Path("profile.toml"))
    rules = None if request.text is None else parse(request.text, "the rules")
    return Vocabulary(
        topics=tuple(_known_topics(profile, rules, robot_topics)),
        every_topic=_properties(ARRIVAL_PROPERTIES.values()),
    )


def _known_topics(
    profile: Profile | None, rules: ParseResult | None, robot_topics: Mapping[str, str]
) -> Iterator[KnownTopic]:
    """Every topic once, by the most trusted who names it; types from whoever knows them."""
    by_source: dict[TopicSource, dict[str, str | None]] = {
        TopicSource.PROFILE: {}
        if profile is None
        else {name: entry.type_name for name, entry in profile.topics.items()},
        TopicSource.ROBOT: dict(robot_topics),
        TopicSource.RULES: dict.fromkeys(sorted(topics_in(rules)) if rules else ()),
        TopicSource.EXAMPLE: dict.fromkeys(_EXAMPLE_TOPICS),
    }
    sources: dict[str, TopicSource] = {}
    types: dict[str, str] = {}
    for source, topics in by_source.items():
        for topic, type_name in topics.items():
            sources.setdefault(topic, source)
            if type_name is not None:
                types.setdefault(topic, type_name)
    for topic, source in sources.items():
        known = types.get(topic) or next(iter(usual_types(topic)), None)
        yield KnownTopic(
            topic=topic,
            type=known,
            properties=_properties(properties_of(known or "").values()),
            bounds=_properties(properties_for_bounds().get(known or "", ())),
            source=source,
        )


def _properties(specs: Iterable[PropertySpec]) -> tuple[Property, ...]:
    return tuple(Property(name=spec.name, unit=spec.unit, meaning=spec.meaning) for spec in specs)


def topics_in(rules: ParseResult) -> set[str]:
    """What the rules name."""
    names: set[str] = set()
    for statement in rules.file.statements:
        if isinstance(statement, Block):
            actions = (*statement.then, *statement.otherwise)
            names.update(one.topic.text for one in sets_in(actions))
            names.update(one.topic.text for one in bounds_in(actions))
            names.update(topic.text for one in records_in(actions) for topic in one.topics)
            names.update(check.topic.text for check in checks_in(statement.condition))
        else:
            names.add(statement.topic.text)
    return names
