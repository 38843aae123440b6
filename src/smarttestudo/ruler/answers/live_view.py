# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What robots say, for the page.

A robot here is a running ``testudo run``: its ``node`` is ``/smarttestudo``, or ``ada:/smarttestudo`` where
it has a link and a name on it. Rates are in Hz, bandwidths in KB/s of 1000 B,
and null is "not known", but for ``target_hz``, where it is Full.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator

from msgspec import Struct

from smarttestudo.domain.bound_texts import bound_texts
from smarttestudo.domain.decision import Reason
from smarttestudo.domain.link_state import LinkState, TopicOnLink
from smarttestudo.domain.status import BlockStatus, RulesOrigin, RuntimeStatus, Silence, TopicStatus
from smarttestudo.domain.units import BYTES_PER_KB, NS_PER_S
from smarttestudo.ruler.answers.page_words import TruthName, truth_name
from smarttestudo.ruler.answers.robot_watch import RuleWords, SeenRobot


class LinkView(Struct, frozen=True, kw_only=True):
    """A robot's link to its operator: what it carries, its least round trip, and how often it was down."""

    connected: bool
    capacity_kb_per_s: float | None
    round_trip_ms: float | None
    outages: int


class TopicLinkView(Struct, frozen=True, kw_only=True):
    """A topic on a link: the age of its last message at the operator, and its messages since the start.

    ``replaced`` gave way to newer ones, ``overflowed`` are lost though none may be; 0 once none was for a
    minute.
    """

    age_ms: float | None
    replaced: int
    overflowed: int
    queued_bytes: int


class OldestTopic(Struct, frozen=True, kw_only=True):
    """The topic whose last message was the oldest when it arrived at the operator."""

    topic: str
    age_ms: float


class RobotSummary(Struct, frozen=True, kw_only=True):
    """One robot. ``rules`` is the origin of its rules; ``waiting``: pushed, and not confirmed yet.

    ``label`` is what people call it. ``waits_s`` is how long pushed rules still hold unless they are
    confirmed. ``is_heard`` is false once it has been silent for longer than it should be; ``heard_s_ago`` is
    the time since its last status. ``lost`` counts messages that overflowed on the link, of all topics that
    lost some within the last minute.
    """

    node: str
    label: str
    is_heard: bool
    heard_s_ago: float
    rules_hash: str
    rules_files: tuple[str, ...]
    rules: RulesOrigin
    waits_s: float | None
    topics: int
    budget_kb_per_s: float | None
    out_kb_per_s: float
    link: LinkView | None
    lost: int
    oldest: OldestTopic | None


class LiveTopic(Struct, frozen=True, kw_only=True):
    """A relayed topic now; ``topic`` is its full name, ``reason`` and ``rule`` are those of its rate.

    ``silence`` is why nothing is received, ``problem`` why it cannot be relayed. ``bounds`` say which bound
    of each property holds, what decided it, and whether that is in doubt.
    """

    topic: str
    output: str
    type: str | None
    source_hz: float | None
    target_hz: float | None
    actual_hz: float | None
    error_percent: float | None
    keeps_rate: bool
    out_kb_per_s: float
    in_kb_per_s: float
    rule: str | None
    line: int | None
    reason: Reason
    silence: Silence | None
    problem: str | None
    link: TopicLinkView | None
    bounds: tuple[str, ...]


class LiveTime(Struct, frozen=True, kw_only=True):
    """A ``For`` or ``Within`` of a rule.

    ``held_s`` is for how long what a ``For`` is about has held; for a ``Within``, for how long it has not;
    null while that is unknown.
    """

    state: TruthName
    held_s: float | None


class LiveBlock(Struct, frozen=True, kw_only=True):
    """The condition of a rule, at its place in the robot's file number ``file``.

    ``label`` is what decisions call it; empty until the robot's rules were read. ``times`` are in the order
    in which they end in the text.
    """

    file: int
    line: int
    column: int
    state: TruthName
    label: str
    times: tuple[LiveTime, ...]


class LiveCheck(Struct, frozen=True, kw_only=True):
    """A check at its place in the robot's file number ``file``, and the value that it reads.

    The words of the check, as written there, find it in another text: what it says of a value does not depend
    on its place. They are empty until the robot's rules were read.
    """

    file: int
    line: int
    column: int
    state: TruthName
    value: float | None
    topic: str
    property: str
    op: str
    limit: float | None


class Live(Struct, frozen=True, kw_only=True, tag_field="kind", tag="live"):
    """What a robot does now; ``stamp_s`` is its own clock, in seconds since 1970.

    ``status_kb_per_s`` is what its statuses themselves take of the link at most, ``full_names`` are those of
    topics that its rules call otherwise. ``blocks_left_out`` rules are beyond those that a status holds.
    """

    node: str
    stamp_s: float
    rules_hash: str
    rules: RulesOrigin
    waits_s: float | None
    cpu_percent: float | None
    memory_mb: float | None
    budget_kb_per_s: float | None
    out_kb_per_s: float
    status_kb_per_s: float
    link: LinkView | None
    topics: tuple[LiveTopic, ...]
    blocks: tuple[LiveBlock, ...]
    blocks_left_out: int
    checks: tuple[LiveCheck, ...]
    full_names: dict[str, str]


_DIGITS = 3


def robot_summaries(robots: Iterable[SeenRobot], now_s: float) -> tuple[RobotSummary, ...]:
    """A line for each robot, by node."""
    return tuple(_robot(one, now_s) for one in sorted(robots, key=lambda one: one.status.robot_id))


def live_model(seen: SeenRobot) -> Live:
    """All that a page shows of a robot."""
    status, words = seen.status, seen.words
    return Live(
        node=status.robot_id,
        stamp_s=status.stamp_ns / NS_PER_S,
        rules_hash=status.rules.sha256,
        rules=status.rules.origin,
        waits_s=status.rules.waits_s,
        cpu_percent=status.cpu_percent,
        memory_mb=status.memory_mb,
        budget_kb_per_s=status.budget_kb_per_s,
        out_kb_per_s=round(status.out_kb_per_s, _DIGITS),
        status_kb_per_s=round(seen.size_bytes * status.status_hz / BYTES_PER_KB, _DIGITS),
        link=_link(status.link),
        topics=tuple(_topic(name, topic) for name, topic in status.topics.items()),
        blocks=tuple(_block(block, words) for block in status.blocks),
        blocks_left_out=status.blocks_left_out,
        checks=tuple(check for block in status.blocks for check in _checks(block, words)),
        full_names=dict(words.full_names),
    )


def _robot(seen: SeenRobot, now_s: float) -> RobotSummary:
    status = seen.status
    return RobotSummary(
        node=status.robot_id,
        label=robot_label(status),
        is_heard=seen.is_heard(now_s),
        heard_s_ago=round(max(now_s - seen.heard_s, 0.0), _DIGITS),
        rules_hash=status.rules.sha256,
        rules_files=status.rules.paths,
        rules=status.rules.origin,
        waits_s=status.rules.waits_s,
        topics=len(status.topics),
        budget_kb_per_s=status.budget_kb_per_s,
        out_kb_per_s=round(status.out_kb_per_s, _DIGITS),
        link=_link(status.link),
        lost=sum(_lost(topic.on_link) for topic in status.topics.values()),
        oldest=_oldest(status),
    )


def robot_label(status: RuntimeStatus) -> str:
    """What people call the robot."""
    return status.robot or status.node


def _link(link: LinkState | None) -> LinkView | None:
    if link is None:
        return None
    return LinkView(
        connected=link.is_connected,
        capacity_kb_per_s=link.capacity_kb_per_s,
        round_trip_ms=link.round_trip_ms,
        outages=link.outages,
    )


def _oldest(status: RuntimeStatus) -> OldestTopic | None:
    ages_ms = {
        name: topic.on_link.age_ms
        for name, topic in status.topics.items()
        if topic.on_link is not None and topic.on_link.age_ms is not None
    }
    oldest = max(ages_ms, key=lambda name: ages_ms[name], default=None)
    return None if oldest is None else OldestTopic(topic=oldest, age_ms=ages_ms[oldest])


def _on_link(on_link: TopicOnLink | None) -> TopicLinkView | None:
    if on_link is None:
        return None
    counts = on_link.counts
    return TopicLinkView(
        age_ms=on_link.age_ms,
        replaced=counts.replaced,
        overflowed=_lost(on_link),
        queued_bytes=counts.queued_bytes,
    )


def _lost(on_link: TopicOnLink | None) -> int:
    """What overflowed of a topic that still loses messages."""
    return on_link.counts.overflowed if on_link is not None and on_link.counts.is_losing else 0


def _topic(name: str, topic: TopicStatus) -> LiveTopic:
    return LiveTopic(
        topic=name,
        output=topic.output,
        type=topic.type_name,
        source_hz=topic.source_hz,
        target_hz=None if math.isinf(topic.target_hz) else topic.target_hz,
        actual_hz=topic.actual_hz,
        error_percent=topic.error_percent,
        keeps_rate=topic.keeps_rate,
        out_kb_per_s=topic.out_kb_per_s,
        in_kb_per_s=topic.in_kb_per_s,
        rule=topic.rule,
        line=topic.line,
        reason=topic.reason,
        silence=topic.silence,
        problem=topic.problem,
        link=_on_link(topic.on_link),
        bounds=bound_texts(topic.within, topic.bound_reasons),
    )


def _block(block: BlockStatus, words: RuleWords) -> LiveBlock:
    return LiveBlock(
        file=block.file,
        line=block.line,
        column=block.column,
        state=truth_name(block.state),
        label=words.labels.get((block.file, block.line, block.column), ""),
        times=tuple(LiveTime(state=truth_name(one.state), held_s=one.held_s) for one in block.times),
    )


def _checks(block: BlockStatus, words: RuleWords) -> Iterator[LiveCheck]:
    for check in block.checks:
        written = words.checks.get((block.file, check.line, check.column))
        yield LiveCheck(
            file=block.file,
            line=check.line,
            column=check.column,
            state=truth_name(check.state),
            value=check.value,
            topic="" if written is None else written.topic.text,
            property="" if written is None else written.property,
            op="" if written is None else written.operator.value,
            limit=None if written is None else written.value,
        )
