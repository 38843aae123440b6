# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The topics of a replay: what rules decode of a recording, what is relayed of it, and what it lacks."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from smarttestudo.bags.definitions import RosbagDecoder
from smarttestudo.bags.metadata_text import offered_qos
from smarttestudo.bags.qos import qos_profiles
from smarttestudo.domain.errors import RecordingError, UsageError
from smarttestudo.domain.names import (
    DECISIONS_TOPIC,
    OWN_TOPICS,
    TEXT_TYPE,
    is_own_topic,
    is_source,
    output_name,
)
from smarttestudo.domain.recording import Channel, first_of_topics
from smarttestudo.domain.signal import ArrivalProperty, Signal
from smarttestudo.language.properties.field_path import MESSAGE_PREFIX
from smarttestudo.language.rule_set import RuleSet
from smarttestudo.robot.decisions import DECISIONS_QOS

_INDEX = re.compile(r"\[[^\]]*\]")


def require_decodable(channels: Sequence[Channel], rule_set: RuleSet, decoder: RosbagDecoder) -> None:
    """Raise ``RecordingError`` for a topic that a check reads and that cannot be decoded."""
    read = _topics_decoded(rule_set)
    reasons = [(one, decoder.why_undecodable(one)) for one in channels if one.topic in read]
    decodable = {(one.topic, one.type_name) for one, why in reasons if why is None}
    first = first_of_topics(channels)
    for channel, why in reasons:
        key = (channel.topic, channel.type_name)
        if why is not None and key not in decodable and channel.type_name == first[channel.topic].type_name:
            cause = f"a check reads it, and it cannot be decoded: {why}"
            raise RecordingError(cause, place=channel.topic, remedy="leave out the check")


def _topics_decoded(rule_set: RuleSet) -> frozenset[str]:
    """Topics of which checks read more than arrivals."""
    return frozenset(signal.topic for signal in rule_set.signals if ArrivalProperty.of(signal) is None)


@dataclass(frozen=True, slots=True, kw_only=True)
class ReplayTopics:
    """By source: the channel of each recorded topic, what relayed ones are called, where they are written.

    ``unread`` are the signals of fields that nobody can read, ``redefined`` the sources whose types are not
    those of ROS 2.
    """

    sources: Mapping[str, Channel]
    output_topics: Mapping[str, str]
    outputs: Mapping[str, Channel]
    unread: Collection[Signal]
    redefined: Collection[str]


def replay_topics(
    channels: Sequence[Channel], rule_set: RuleSet, decoder: RosbagDecoder, output_topic: str
) -> ReplayTopics:
    """The topics of a replay.

    Raises ``UsageError`` where ``output_topic`` gives several topics one name, or a name that is none or is
    that of a topic of SmartTestudo.
    """
    sources = first_of_topics(channels)
    names = {topic: output_name(topic, output_topic) for topic in rule_set.relayed}
    outputs = {
        topic: replace(sources[topic], topic=name) for topic, name in names.items() if topic in sources
    }
    for topic, output in outputs.items():
        if output.topic in OWN_TOPICS:
            cause = f"{topic} would be relayed to {output.topic}, where SmartTestudo says what it does"
            raise UsageError(cause, place="--output-topic", remedy="choose another pattern")
    unread = {
        signal
        for signal in rule_set.signals
        if signal.topic in sources and _field(signal) in decoder.unread(sources[signal.topic])
    }
    redefined = {topic for topic, channel in sources.items() if not decoder.is_standard(channel)}
    return ReplayTopics(
        sources=sources, output_topics=names, outputs=outputs, unread=unread, redefined=redefined
    )


def _field(signal: Signal) -> str:
    return _INDEX.sub("", signal.property.removeprefix(MESSAGE_PREFIX))


def decisions_channel() -> Channel:
    """The topic of decisions, as a live run has it."""
    return Channel(
        topic=DECISIONS_TOPIC,
        type_name=TEXT_TYPE,
        qos=qos_profiles(offered_qos(DECISIONS_QOS)),
        transient_local=DECISIONS_QOS.transient_local,
    )


def earlier_topics(channels: Sequence[Channel], rule_set: RuleSet, *, is_written: bool) -> Iterator[str]:
    """A notice for each topic that an earlier run said of itself, where that may be missed.

    Rules neither relay nor read it, and the new recording, if it ``is_written``, has decisions of its own.
    """
    named = {*rule_set.relayed, *(signal.topic for signal in rule_set.signals)}
    own = {one.topic for one in channels if is_own_topic(one.topic, one.type_name)}
    for topic in sorted(own):
        if is_written and topic.endswith(DECISIONS_TOPIC):
            yield f"{topic}: left out, as it is of an earlier run; the new recording has decisions of its own"
        elif topic in named:
            yield f"{topic}: left out, as SmartTestudo said it of itself; rules neither relay nor read it"


def absent_topics(rule_set: RuleSet, recorded: Collection[str]) -> Iterator[str]:
    """A notice for each topic of the rules that the recording does not hold."""
    relayed = rule_set.relayed
    for topic in relayed:
        if topic not in recorded:
            yield f"{topic}: not in the recording, so nothing of it is relayed"
    for topic in sorted(rule_set.topics_read.difference(recorded, relayed)):
        yield f"{topic}: not in the recording, so checks of it stay unknown"
    for source in sorted({signal.topic for signal in rule_set.signals if is_source(signal.topic)}):
        yield f"{source}: no recording has it, so checks of it stay unknown"
