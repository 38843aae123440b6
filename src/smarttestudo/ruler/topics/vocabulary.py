# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The topics and properties to suggest while rules are written."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from enum import Enum
from pathlib import Path

from msgspec import Struct

from smarttestudo.domain.profile import AccuracyTiers, Profile, TopicProfile
from smarttestudo.domain.rate import Tier
from smarttestudo.language.known_types import KnownTypes
from smarttestudo.language.parser import ParseResult, parse
from smarttestudo.language.properties import (
    ARRIVAL_PROPERTIES,
    SOURCE_MEANINGS,
    PropertySpec,
    conventional_types,
    properties_for_bounds,
    properties_of,
)
from smarttestudo.language.properties.field_path import ANY
from smarttestudo.language.syntax import Block
from smarttestudo.language.syntax_walks import (
    topic_names_in,
)
from smarttestudo.optimizer.problem import interval_hz
from smarttestudo.ruler.job import job
from smarttestudo.ruler.topics.known_fields import FieldKind, KnownField, known_fields
from smarttestudo.rules.profile_file import parse_profile


class TopicSource(Enum):
    """Source of a topic's name; the value is its name in JSON, the order that of trust."""

    PROFILE = "profile"
    ROBOT = "robot"
    RULES = "rules"
    EXAMPLE = "example"


class Property(Struct, frozen=True, kw_only=True):
    """A property that a check can read or a bound can be about.

    ``words`` are what it can be equal to, beside a number or a text: true and false, or constants.
    ``levels`` are the loosest and the tightest bound of each of the six levels, where the profile has them.
    """

    name: str
    unit: str
    meaning: str
    kind: FieldKind = FieldKind.NUMBER
    words: tuple[str, ...] = ()
    levels: tuple[tuple[float, float], ...] | None


class KnownTopic(Struct, frozen=True, kw_only=True):
    """A topic, its type where anybody knows it, else the one that its name stands for, and who names it.

    ``properties`` are those that checks read, ``bounds`` those that only a ``KeepWithin`` can name.
    ``source_hz`` is the profile's, ``levels_hz`` the lowest and highest rate of each of its six levels.
    ``used_by`` are the labels of the rules that name the topic, and ``default`` for statements outside rules.
    ``is_published``: a robot that is heard now has it.
    """

    topic: str
    type: str | None
    properties: tuple[Property, ...]
    bounds: tuple[Property, ...]
    source: TopicSource
    source_hz: float | None
    levels_hz: tuple[tuple[float, float], ...] | None
    used_by: tuple[str, ...]
    is_published: bool


class KnownVitals(Struct, frozen=True, kw_only=True):
    """The machine or the link, by the ``name`` that checks have in the place of a topic."""

    name: str
    meaning: str
    properties: tuple[Property, ...]


class Allowed(Struct, frozen=True, kw_only=True):
    """Parameters and services that the profile allows rules: the parameters of each node, and services."""

    parameters: Mapping[str, tuple[str, ...]]
    calls: tuple[str, ...]


class VocabularyRequest(Struct, frozen=True, kw_only=True):
    """The texts that an editor has open."""

    text: str | None = None
    profile_text: str | None = None


class Vocabulary(Struct, frozen=True, kw_only=True):
    """Words that an editor suggests; ``every_topic`` are the properties of any topic.

    Checks alone can name ``vitals``.
    """

    topics: tuple[KnownTopic, ...]
    every_topic: tuple[Property, ...]
    vitals: tuple[KnownVitals, ...]
    allowed: Allowed


DEFAULT_USER = "default"
"""Who names a topic outside of rules."""

_EXAMPLE_TOPICS = (
    *("/odom", "/scan", "/battery_state", "/imu", "/joint_states", "/tf"),
    *("/camera/camera_info", "/camera/image_raw", "/camera/image_raw/compressed", "/cmd_vel"),
)
"""The topics of a TurtleBot3, what people look at first; commands come last."""


RobotTopics = Callable[[], Mapping[str, str]]
"""The types of what robots publish now."""


@job("POST /api/vocabulary", reads=True)
def vocabulary(request: VocabularyRequest, robot_topics: RobotTopics) -> Vocabulary:
    """Words to suggest."""
    profile_text = request.profile_text
    profile = None if profile_text is None else parse_profile(profile_text, Path("profile.toml"))
    rules = None if request.text is None else parse(request.text, "the rules")
    from smarttestudo.bags.type_definitions import recorded_types  # noqa: PLC0415  it knows all of ROS 2

    return Vocabulary(
        topics=tuple(_known_topics(profile, rules, robot_topics(), recorded_types())),
        every_topic=_properties(ARRIVAL_PROPERTIES.values(), TopicProfile()),
        vitals=tuple(
            KnownVitals(
                name=name,
                meaning=meaning,
                properties=_properties(properties_of(name).values(), TopicProfile()),
            )
            for name, meaning in SOURCE_MEANINGS.items()
        ),
        allowed=_allowed(profile or Profile()),
    )


def _allowed(profile: Profile) -> Allowed:
    nodes = sorted(profile.allow_parameters.items())
    parameters = {node: tuple(sorted(names)) for node, names in nodes}
    return Allowed(parameters=parameters, calls=tuple(sorted(profile.allow_calls)))


def _known_topics(
    profile: Profile | None,
    rules: ParseResult | None,
    robot_topics: Mapping[str, str],
    known_types: KnownTypes,
) -> Iterator[KnownTopic]:
    """Every topic once, by the most trusted who names it; types from whoever knows them."""
    users = _users(rules)
    by_source: dict[TopicSource, dict[str, str | None]] = {
        TopicSource.PROFILE: {}
        if profile is None
        else {name: entry.type_name for name, entry in profile.topics.items()},
        TopicSource.ROBOT: dict(robot_topics),
        TopicSource.RULES: dict.fromkeys(sorted(users)),
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
        known = types.get(topic) or next(iter(conventional_types(topic)), None)
        entry = TopicProfile() if profile is None else profile.topic(topic)
        tiers_hz = entry.tiers_hz
        yield KnownTopic(
            topic=topic,
            type=known,
            properties=_checked(known or "", known_types, entry),
            bounds=_properties(properties_for_bounds().get(known or "", ()), entry),
            source=source,
            source_hz=entry.source_hz,
            levels_hz=None if tiers_hz is None else tuple(interval_hz(tier, tiers_hz) for tier in Tier),
            used_by=tuple(users.get(topic, ())),
            is_published=topic in robot_topics,
        )


def _properties(specs: Iterable[PropertySpec], topic: TopicProfile) -> tuple[Property, ...]:
    return tuple(_property(spec, topic.accuracy(spec.name)) for spec in specs)


_STANDS_FOR = {"goal": f"status_list{ANY}.status"}
"""Named properties with the constants of a field."""


def _checked(type_name: str, types: KnownTypes, topic: TopicProfile) -> tuple[Property, ...]:
    """The named properties of a type, then its fields; of one with such properties those with words alone."""
    named = properties_of(type_name)
    fields = {field.path: field for field in known_fields(types, type_name)}
    known = (
        _property(spec, topic.accuracy(spec.name), fields.get(_STANDS_FOR.get(spec.name, spec.name)))
        for spec in named.values()
    )
    more = (
        Property(name=field.path, unit="", meaning="", kind=field.kind, words=field.words, levels=None)
        for field in fields.values()
        if field.path not in named and not (named and field.kind is FieldKind.NUMBER and not field.words)
    )
    return (*known, *more)


def _property(spec: PropertySpec, tiers: AccuracyTiers | None, field: KnownField | None = None) -> Property:
    return Property(
        name=spec.name,
        unit=spec.unit,
        meaning=spec.meaning,
        kind=FieldKind.NUMBER if field is None else field.kind,
        words=() if field is None else field.words,
        levels=None if tiers is None else tuple(map(tiers.interval, Tier)),
    )


def topics_in(rules: ParseResult) -> set[str]:
    """All topics that the rules name."""
    return {name.text for statement in rules.file.statements for name in topic_names_in(statement)}


def _users(rules: ParseResult | None) -> dict[str, list[str]]:
    """For each topic that the rules name, who names it, each once and in the order of the text."""
    users: dict[str, list[str]] = {}
    for statement in () if rules is None else rules.file.statements:
        label = statement.label if isinstance(statement, Block) else DEFAULT_USER
        for topic in topic_names_in(statement):
            labels = users.setdefault(topic.text, [])
            if label not in labels:
                labels.append(label)
    return users
