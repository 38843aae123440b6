# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Checks beside the range of what they read."""

from __future__ import annotations

from collections.abc import Iterator

from smarttestudo.checks import wording
from smarttestudo.checks.rule_check import Found
from smarttestudo.checks.rule_model import RuleModel
from smarttestudo.checks.written import CheckSite
from smarttestudo.domain.signal import ArrivalProperty, Truth
from smarttestudo.language.properties import PropertySpec


def checks_that_are(truth: Truth, word: str, book: RuleModel) -> Iterator[Found]:
    """The checks that are ``truth`` for every value of what they read; ``word`` says never or always."""
    for one in book.checks:
        if one.truth is truth and one.spec is not None:
            yield Found(
                path=one.path,
                span=one.check.span,
                message=f"{wording.check_text(one.check)} {word} holds: {_range_text(one.spec)}",
                hint=_hint(one, book),
            )


def _range_text(spec: PropertySpec) -> str:
    if spec.minimum is not None and spec.maximum is not None:
        low, high = wording.number(spec.minimum), wording.number(spec.maximum)
        return f"{spec.name} lies between {low} and {high} {spec.unit}"
    if spec.minimum is not None:
        return f"{spec.name} is never below {wording.number(spec.minimum)} {spec.unit}"
    return f"{spec.name} is in {spec.unit}"


def _hint(one: CheckSite, book: RuleModel) -> str:
    name = one.signal.property
    if ArrivalProperty.named(name):
        return f"a field of the message that is called {name} is written msg.{name}"
    if book.context.known_type(one.signal.topic) is None:
        return f"if {name} is a plain field of {one.signal.topic}, write msg.{name}"
    return "correct the number"
