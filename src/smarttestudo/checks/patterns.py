# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Lint rules of patterns, which stand for topics of a kind, there or not yet."""

from __future__ import annotations

from collections.abc import Hashable, Iterator

from smarttestudo.checks.lint_rule import Found, lint_rule
from smarttestudo.checks.rule_model import RuleModel
from smarttestudo.domain.finding import Severity
from smarttestudo.domain.rate import Tier
from smarttestudo.language.resolved_rules import ResolvedPattern
from smarttestudo.language.syntax import KeepAtLeast, KeepWithin, RecordIncident, SetFrequency
from smarttestudo.language.topic_pattern import literal_beginning, matching, may_overlap

_MOST_COMPARED = 50
"""Patterns of one beginning with which another one is compared."""
_COUNTS = {
    SetFrequency: "the last one counts",
    KeepAtLeast: "the higher floor counts",
    KeepWithin: "the tighter bound counts",
}


@lint_rule("equal-patterns", Severity.WARNING)
def equal_patterns(rules: RuleModel) -> Iterator[Found]:
    """Two patterns whose beginnings are equally long can match one topic, and ask different things of it.

    Of two patterns that of the longer beginning counts, what stands before its first star; here neither is
    longer. Which of the two was meant for such a topic, nobody can know.
    """
    earlier: dict[Hashable, list[ResolvedPattern]] = {}
    for pattern in rules.patterns:
        statement = pattern.statement
        if isinstance(statement, RecordIncident):
            continue
        bounded = statement.property if isinstance(statement, KeepWithin) else ""
        place = (type(statement), pattern.branch, bounded, literal_beginning(pattern.pattern))
        group = earlier.setdefault(place, [])
        for other in group:
            if _value(other) != _value(pattern) and may_overlap(pattern.pattern, other.pattern):
                yield Found(
                    path=pattern.path,
                    span=pattern.name.span,
                    message=f"{pattern.name.text} and {other.name.text} (line {other.name.span.line}) can "
                    f"match one topic, and neither has the longer beginning: {_COUNTS[type(statement)]}",
                    hint="write a longer beginning, or the full name of the topic that differs",
                )
                break
        if len(group) < _MOST_COMPARED:
            group.append(pattern)


def _value(pattern: ResolvedPattern) -> object:
    statement = pattern.statement
    if isinstance(statement, KeepWithin):
        return statement.bound
    return None if isinstance(statement, RecordIncident) else statement.rate.value


@lint_rule("level-of-pattern", Severity.ERROR)
def level_of_pattern(rules: RuleModel) -> Iterator[Found]:
    """A pattern has a quality level.

    A level stands for the rate that the optimizer finds for one topic. What a pattern matches is known on the
    robot only, and each of those topics has levels of its own.
    """
    for pattern in rules.patterns:
        statement = pattern.statement
        if isinstance(statement, RecordIncident):
            continue
        ends = [statement.bound] if isinstance(statement, KeepWithin) else [statement.rate.value]
        if isinstance(statement, SetFrequency):
            ends = [end.value for end in statement.ends]
        level = next((end for end in ends if isinstance(end, Tier)), None)
        if level is not None:
            yield Found(
                path=pattern.path,
                span=statement.span,
                message=f"{level.value} stands for the rate of one topic, and {pattern.name.text} for any "
                "number",
                hint="write a number, or name the topics in full",
            )


@lint_rule("unmatched-pattern", Severity.INFO)
def unmatched_pattern(rules: RuleModel) -> Iterator[Found]:
    """A pattern matches no topic of the recording of --bag, or of the robot of --connect.

    Usually a name in it is misspelt. Hidden topics, a part of whose name begins with an underscore, ROS's own
    and those below /testudo are never matched: they are relayed by their full names.
    """
    there = rules.context.bag_topics
    for pattern in rules.patterns if there is not None else ():
        if not matching(pattern.pattern, there or ()):
            yield Found(
                path=pattern.path,
                span=pattern.name.span,
                message=f"{rules.context.topics_lack} topic that {pattern.name.text} matches",
                hint="* is one name, ** any number of names; hidden topics are named in full",
            )


@lint_rule("pattern-without-default", Severity.WARNING, needs_all_statements=True)
def pattern_without_default(rules: RuleModel) -> Iterator[Found]:
    """A block sets the topics that a pattern matches, and no default can match any of them.

    Where the block does not hold, and while its values are unknown, such a topic is Full: every message
    travels. For cameras that can be more than the whole link.
    """
    by_place: dict[tuple[int, bool] | None, list[str]] = {}
    for one in rules.patterns:
        if isinstance(one.statement, SetFrequency):
            by_place.setdefault(one.branch, []).append(one.pattern)
    for pattern in rules.patterns:
        if pattern.branch is None or not isinstance(pattern.statement, SetFrequency):
            continue
        order, is_else = pattern.branch
        others = (*by_place.get(None, ())[:_MOST_COMPARED], *by_place.get((order, not is_else), ()))
        is_known = bool(matching(pattern.pattern, rules.context.types.topics))
        if is_known or any(may_overlap(pattern.pattern, other) for other in others):
            # What has no default among topics that are there is found by name.
            continue
        yield Found(
            path=pattern.path,
            span=pattern.name.span,
            message=f"{pattern.name.text} has no default: what it matches is Full where no block sets it and "
            "while values are unknown",
            hint=f"add a default: SetFrequency {pattern.name.text} and a rate",
        )
