# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Properties that a topic's type does not have."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache

from smarttestudo.adirf.checks import wording
from smarttestudo.adirf.checks.message_fields import has_field
from smarttestudo.adirf.checks.rule_book import RuleBook
from smarttestudo.adirf.checks.rule_check import Example, Found, RuleCheck
from smarttestudo.adirf.checks.written import WrittenCheck
from smarttestudo.adirf.parser.suggestions import closest, did_you_mean
from smarttestudo.adirf.properties import ARRIVAL_PROPERTIES, known_types, properties_of
from smarttestudo.domain.finding import Fix, Severity


def _find(book: RuleBook) -> Iterator[Found]:
    type_of = cache(book.context.type_of)
    known = known_types()
    for one in book.checks:
        type_name = type_of(one.signal.topic)
        if type_name in known and not _exists(one.signal.property, type_name):
            yield _found(one, type_name)


def _exists(name: str, type_name: str) -> bool:
    return name in ARRIVAL_PROPERTIES or name in properties_of(type_name) or has_field(type_name, name)


def _found(one: WrittenCheck, type_name: str) -> Found:
    name = one.signal.property
    known = tuple(properties_of(type_name))
    close = closest(name, (*known, *ARRIVAL_PROPERTIES))
    return Found(
        path=one.path,
        span=one.check.property_span,
        message=f"{type_name}, the type of {one.signal.topic}, has no property or field {name}",
        hint=did_you_mean(close) if close else f"it has {wording.listed(known)}",
        fix=Fix(span=one.check.property_span, replacement=close, title=f"write '{close}'") if close else None,
    )


_ODOMETRY = {"/odom": "nav_msgs/msg/Odometry"}

CHECK = RuleCheck(
    code="unknown-property",
    severity=Severity.WARNING,
    meaning="A check reads a property that the topic's type does not have.",
    why="The check stays unknown for good: its block never decides, and as long as it is in doubt the topic "
    "gets the higher of the rates. Types come from the profile or a recording; where none is known, "
    "nothing is said.",
    bad=Example(
        rules="""\
begin
  SetFrequency /odom 10
  If CheckValue /odom pos_x > 5 Then
    SetFrequency /odom 4
end
""",
        bag_topics=_ODOMETRY,
    ),
    good=Example(
        rules="""\
begin
  SetFrequency /odom 10
  If CheckValue /odom pose_x > 5 Then
    SetFrequency /odom 4
end
""",
        bag_topics=_ODOMETRY,
    ),
    find=_find,
)
