# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What robots say, for the page."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping

from smarttestudo.composition.ruler.robot_watch import SeenRobot
from smarttestudo.composition.ruler.rule_words import RuleWords
from smarttestudo.domain.block_status import BlockStatus
from smarttestudo.domain.signal import Truth
from smarttestudo.domain.status import TopicStatus
from smarttestudo.domain.units import BYTES_PER_KB, NS_PER_S
from smarttestudo.web import robot_schemas as schema

_DIGITS = 3
_STATES: Mapping[Truth, schema.StateName] = {
    Truth.TRUE: "true",
    Truth.FALSE: "false",
    Truth.UNKNOWN: "unknown",
}


def robot_models(robots: Iterable[SeenRobot], now_s: float) -> tuple[schema.RobotModel, ...]:
    """A line for each robot, by node."""
    return tuple(_robot(one, now_s) for one in sorted(robots, key=lambda one: one.status.node))


def live_model(seen: SeenRobot) -> schema.Live:
    """All that a page shows of a robot."""
    status, words = seen.status, seen.words
    return schema.Live(
        node=status.node,
        stamp_s=status.stamp_ns / NS_PER_S,
        rules_hash=status.rules.sha256,
        rules=status.rules.origin.value,
        waits_s=status.rules.waits_s,
        cpu_percent=status.cpu_percent,
        memory_mb=status.memory_mb,
        budget_kb_per_s=status.budget_kb_per_s,
        out_kb_per_s=round(status.out_kb_per_s, _DIGITS),
        status_kb_per_s=round(seen.size_bytes * status.status_hz / BYTES_PER_KB, _DIGITS),
        topics=tuple(_topic(name, topic) for name, topic in status.topics.items()),
        blocks=tuple(_block(block, words) for block in status.blocks),
        checks=tuple(check for block in status.blocks for check in _checks(block, words)),
        full_names=dict(words.full_names),
    )


def _robot(seen: SeenRobot, now_s: float) -> schema.RobotModel:
    status = seen.status
    return schema.RobotModel(
        node=status.node,
        is_heard=seen.is_heard(now_s),
        heard_s_ago=round(max(now_s - seen.heard_s, 0.0), _DIGITS),
        rules_hash=status.rules.sha256,
        rules_files=status.rules.paths,
        rules=status.rules.origin.value,
        waits_s=status.rules.waits_s,
        topics=len(status.topics),
    )


def _topic(name: str, topic: TopicStatus) -> schema.LiveTopic:
    return schema.LiveTopic(
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
        reason=topic.reason.value,
        silence=None if topic.silence is None else topic.silence.value,
        problem=topic.problem,
    )


def _block(block: BlockStatus, words: RuleWords) -> schema.LiveBlock:
    return schema.LiveBlock(
        file=block.file,
        line=block.line,
        column=block.column,
        state=_STATES[block.state],
        label=words.labels.get((block.file, block.line, block.column), ""),
    )


def _checks(block: BlockStatus, words: RuleWords) -> Iterator[schema.LiveCheck]:
    for check in block.checks:
        written = words.checks.get((block.file, check.line, check.column))
        yield schema.LiveCheck(
            file=block.file,
            line=check.line,
            column=check.column,
            state=_STATES[check.state],
            value=check.value,
            topic="" if written is None else written.topic.text,
            property="" if written is None else written.property,
            op="" if written is None else written.operator.value,
            limit=None if written is None else written.value,
        )
