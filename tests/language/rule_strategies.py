# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Hypothesis strategies of rule files as syntax trees, of all that the language has.

``bare`` strips a tree of all that is not meaning, for comparison. A strategy is made once for its arguments,
since Hypothesis validates each new one, which takes most of an example's time.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Sequence
from functools import cache
from itertools import zip_longest

from hypothesis import strategies as st

from smarttestudo.domain.finding import Span
from smarttestudo.domain.rate import Tier
from smarttestudo.language.parser.lexer import KEYWORDS
from smarttestudo.language.syntax import (
    Action,
    And,
    Block,
    Check,
    Collection,
    Condition,
    Duration,
    DurationUnit,
    Group,
    KeepAtLeast,
    KeepWithin,
    Not,
    Operator,
    Or,
    RateExpression,
    RateWord,
    RecordIncident,
    RuleFile,
    SetFrequency,
    Statement,
    Timed,
    TimeWord,
    TopicName,
    Until,
)

NOWHERE = Span(line=1, column=1, end_line=1, end_column=1)
TOPICS = ("/odom", "/cmd_vel", "/scan", "/camera/image_raw", "imu", "~/status", "/robot_1/joint_states")
PROPERTIES = (
    "pose_x",
    "speed",
    "rate",
    "age",
    "level",
    "pose.pose.position.x",
    "ranges[0]",
    "msg.rate",
    "a.b[12].c",
    "If",
    "end",
    "_größe",
)
RATE_TEXTS = ("0", "10", "5.0", "007", "2.5", ".5", "7.", "+3", "1e3", "1E-2", "1e6")
NUMBER_TEXTS = (*RATE_TEXTS, "-13", "-0.5", "+.25e+1", "-1e300")
DURATIONS = tuple(
    Duration(text=text, unit=unit, ns=ns, span=NOWHERE)
    for text, unit, ns in (
        ("500", DurationUnit.MILLISECONDS, 500_000_000),
        (".5", DurationUnit.SECONDS, 500_000_000),
        ("0", DurationUnit.SECONDS, 0),
        ("1e1", DurationUnit.SECONDS, 10_000_000_000),
        ("+2.50", DurationUnit.MINUTES, 150_000_000_000),
    )
)
NOT_MEANING = frozenset({"span", "property_span", "parameter_span", "label", "path"})


def bare(node: object) -> object:
    """The meaning of a tree: nested tuples without places, comments and labels."""
    if dataclasses.is_dataclass(node) and not isinstance(node, type):
        kept = [
            field.name
            for field in dataclasses.fields(node)
            if field.compare and field.name not in NOT_MEANING
        ]
        return (type(node).__name__, *(bare(getattr(node, name)) for name in kept))
    return tuple(bare(part) for part in node) if isinstance(node, tuple) else node


@cache
def rates() -> st.SearchStrategy[RateExpression]:
    named = st.sampled_from([*Tier, *RateWord]).map(
        lambda value: RateExpression(value=value, text="", span=NOWHERE)
    )
    return st.one_of(hertz(), named)


@cache
def hertz() -> st.SearchStrategy[RateExpression]:
    return st.builds(
        lambda text, has_unit: RateExpression(value=float(text), text=text, span=NOWHERE, has_unit=has_unit),
        st.sampled_from(RATE_TEXTS),
        st.booleans(),
    )


@cache
def topic_names(topics: Sequence[str] = TOPICS) -> st.SearchStrategy[TopicName]:
    return st.sampled_from(topics).map(lambda text: TopicName(text=text, span=NOWHERE))


@cache
def checks(
    topics: Sequence[str] = TOPICS, properties: Sequence[str] = PROPERTIES
) -> st.SearchStrategy[Check]:
    return st.builds(
        lambda topic, name, operator, text, until: Check(
            topic=topic,
            property=name,
            property_span=NOWHERE,
            operator=operator,
            value=float(text),
            text=text,
            span=NOWHERE,
            until=until,
        ),
        topic_names(topics),
        st.sampled_from(properties),
        st.sampled_from(Operator),
        st.sampled_from(NUMBER_TEXTS),
        st.one_of(st.none(), st.none(), _untils()),
    )


@cache
def _untils() -> st.SearchStrategy[Until]:
    return st.builds(
        lambda operator, text: Until(operator=operator, value=float(text), text=text, span=NOWHERE),
        st.sampled_from(Operator),
        st.sampled_from(NUMBER_TEXTS),
    )


@cache
def conditions(
    topics: Sequence[str] = TOPICS, properties: Sequence[str] = PROPERTIES, *, max_checks: int = 6
) -> st.SearchStrategy[Condition]:
    """What may stand behind ``If``: a check, a group or a ``Not``, as the parser would build it."""
    return st.recursive(
        checks(topics, properties),
        lambda inner: st.one_of(
            inner.map(lambda operand: Not(operand=operand, span=NOWHERE)),
            _expressions(inner).map(lambda operand: Group(operand=operand, span=NOWHERE)),
            st.builds(_timed, inner, st.sampled_from(TimeWord), st.sampled_from(DURATIONS)),
        ),
        max_leaves=max_checks,
    )


def _timed(operand: Condition, word: TimeWord, duration: Duration) -> Condition:
    """Behind a ``Not`` without parentheses, the time would belong to what is negated."""
    grouped = Group(operand=operand, span=NOWHERE) if isinstance(operand, Not) else operand
    return Timed(operand=grouped, word=word, duration=duration, span=NOWHERE)


def _expressions(factor: st.SearchStrategy[Condition]) -> st.SearchStrategy[Condition]:
    terms = st.lists(factor, min_size=1, max_size=3).map(
        lambda parts: parts[0] if len(parts) == 1 else And(operands=tuple(parts), span=NOWHERE)
    )
    return st.lists(terms, min_size=1, max_size=3).map(
        lambda parts: parts[0] if len(parts) == 1 else Or(operands=tuple(parts), span=NOWHERE)
    )


@cache
def set_frequencies(topics: Sequence[str] = TOPICS) -> st.SearchStrategy[SetFrequency]:
    return st.builds(SetFrequency, topic=topic_names(topics), rate=rates(), span=st.just(NOWHERE))


@cache
def keep_at_leasts(topics: Sequence[str] = TOPICS) -> st.SearchStrategy[KeepAtLeast]:
    return st.builds(KeepAtLeast, topic=topic_names(topics), rate=hertz(), span=st.just(NOWHERE))


@cache
def keep_withins(
    topics: Sequence[str] = TOPICS, properties: Sequence[str] = PROPERTIES
) -> st.SearchStrategy[KeepWithin]:
    return st.builds(
        lambda topic, name, bound: KeepWithin(
            topic=topic,
            property=name,
            property_span=NOWHERE,
            bound=bound if isinstance(bound, Tier) else float(bound),
            text="" if isinstance(bound, Tier) else bound,
            span=NOWHERE,
        ),
        topic_names(topics),
        # A keyword is a property only where a comparison follows.
        st.sampled_from([name for name in (*properties, "position", "orientation") if name not in KEYWORDS]),
        st.sampled_from([*RATE_TEXTS, *Tier]),
    )


@cache
def names() -> st.SearchStrategy[str]:
    return st.text("abc \"\\é'//", min_size=1, max_size=8).filter(str.strip)


@cache
def records(topics: Sequence[str] = TOPICS) -> st.SearchStrategy[RecordIncident]:
    return st.builds(
        RecordIncident,
        name=names(),
        topics=st.lists(topic_names(topics), max_size=2).map(tuple),
        before=st.sampled_from(DURATIONS),
        # A window of no time at all is refused.
        after=st.sampled_from([one for one in DURATIONS if one.ns]),
        span=st.just(NOWHERE),
    )


def _spoken_of(action: SetFrequency | KeepWithin) -> tuple[str, ...]:
    """What a branch should say once."""
    return (action.topic.text, action.property) if isinstance(action, KeepWithin) else (action.topic.text,)


@cache
@st.composite
def actions(
    draw: st.DrawFn, topics: Sequence[str] = TOPICS, properties: Sequence[str] = PROPERTIES
) -> tuple[Action, ...]:
    """The statements of a branch; no topic is set and no property bound twice."""
    found: list[Action] = [*draw(_bounds_and_rates(topics, properties)), *draw(_at_most_one_record(topics))]
    return tuple(draw(st.permutations(found)))


@cache
def _bounds_and_rates(
    topics: Sequence[str], properties: Sequence[str]
) -> st.SearchStrategy[list[SetFrequency | KeepWithin]]:
    some = st.one_of(set_frequencies(topics), keep_withins(topics, properties))
    return st.lists(some, min_size=1, max_size=3, unique_by=_spoken_of)


@cache
def _at_most_one_record(topics: Sequence[str]) -> st.SearchStrategy[list[RecordIncident]]:
    return st.lists(records(topics), max_size=1)


@cache
@st.composite
def blocks(draw: st.DrawFn, topics: Sequence[str] = TOPICS, properties: Sequence[str] = PROPERTIES) -> Block:
    """A block, with or without name, priority, ``Else`` and ``EndIf``; no topic twice in a branch."""
    name = draw(_MAYBE_NAMES)
    return Block(
        name=name,
        priority=draw(_MAYBE_PRIORITIES) if name is not None else None,
        label=name or "",
        condition=draw(conditions(topics, properties)),
        then=draw(actions(topics, properties)),
        otherwise=draw(_maybe_actions(topics, properties)),
        has_end_if=draw(_BOOLEANS),
        span=NOWHERE,
        is_disabled=draw(_A_THIRD),
    )


_MAYBE_NAMES = st.none() | names()
_MAYBE_PRIORITIES = st.none() | st.integers(-5, 100)
_BOOLEANS = st.booleans()
_A_THIRD = st.sampled_from([False, False, True])


@cache
def _maybe_actions(topics: Sequence[str], properties: Sequence[str]) -> st.SearchStrategy[tuple[Action, ...]]:
    return st.just(()) | actions(topics, properties)


@cache
@st.composite
def rule_files(
    draw: st.DrawFn,
    topics: Sequence[str] = TOPICS,
    properties: Sequence[str] = PROPERTIES,
    *,
    max_statements: int = 5,
    max_collections: int = 2,
) -> RuleFile:
    """A syntax tree that some text parses to."""
    lists = draw(_lists_of_statements(topics, properties, max_statements, max_collections))
    collections = tuple(
        Collection(statements=tuple(_separable(statements)), span=NOWHERE) for statements in lists
    )
    return RuleFile(path="rules.adirf", collections=collections)


@cache
def _lists_of_statements(
    topics: Sequence[str], properties: Sequence[str], max_statements: int, max_collections: int
) -> st.SearchStrategy[list[list[Statement]]]:
    statement = st.one_of(
        set_frequencies(topics),
        keep_at_leasts(topics),
        keep_withins(topics, properties),
        blocks(topics, properties),
    )
    return st.lists(st.lists(statement, max_size=max_statements), min_size=1, max_size=max_collections)


def _separable(statements: Sequence[Statement]) -> Iterator[Statement]:
    """What follows a block without ``EndIf`` would belong to it: give it one."""
    for statement, following in zip_longest(statements, statements[1:]):
        if isinstance(statement, Block) and following is not None and not isinstance(following, Block):
            yield dataclasses.replace(statement, has_end_if=True)
        else:
            yield statement
