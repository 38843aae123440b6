# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Bounds of properties that the messages do not have."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache, partial

from smarttestudo.checks.rule_check import Example, Found, RuleCheck
from smarttestudo.checks.rule_model import RuleModel
from smarttestudo.checks.unknown_property import Doubt, doubt_about, found_in
from smarttestudo.domain.finding import Severity
from smarttestudo.domain.signal import Signal
from smarttestudo.language.properties import ARRIVAL_PROPERTIES, accuracy_properties_of


def _find(book: RuleModel) -> Iterator[Found]:
    doubt_of = cache(partial(doubt_about, context=book.context, named=accuracy_properties_of))
    for one in (*book.bounds, *book.disabled.bounds):
        doubt = _no_picture(one.signal) or doubt_of(one.signal)
        if doubt is not None:
            yield found_in(one.path, one.statement.property_span, doubt)


def _no_picture(signal: Signal) -> Doubt | None:
    if signal.property not in ARRIVAL_PROPERTIES:
        return None
    return Doubt(
        message=f"{signal.property} is about when messages arrive, and not in them",
        hint="a floor keeps messages coming: KeepAtLeast and a rate",
        close=None,
    )


CHECK = RuleCheck(
    code="unknown-bound",
    severity=Severity.WARNING,
    meaning="A KeepWithin names a property that the messages of the topic do not have.",
    why="What cannot be read cannot be compared: every message passes up to the topic's rate, and the bound "
    "saves nothing. Types come from the profile or a recording, as for checks.",
    bad=Example(
        rules="""\
begin
  SetFrequency /odom Full
  KeepWithin /odom pos 0.05
end
""",
        bag_topics={"/odom": "nav_msgs/msg/Odometry"},
    ),
    good=Example(
        rules="""\
begin
  SetFrequency /odom Full
  KeepWithin /odom position 0.05
end
""",
        bag_topics={"/odom": "nav_msgs/msg/Odometry"},
    ),
    find=_find,
)
