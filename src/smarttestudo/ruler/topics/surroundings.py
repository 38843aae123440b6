# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Findings that need more than a text: the budget, and which topics a robot or a recording has."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from msgspec import Struct, structs

from smarttestudo.checks import CheckContext
from smarttestudo.checks.rule_model import read_rule_model
from smarttestudo.checks.topics import absent_from_bag
from smarttestudo.domain.finding import Finding, Severity
from smarttestudo.domain.names import resolve_topic
from smarttestudo.language.syntax import Block
from smarttestudo.ruler.job import job
from smarttestudo.ruler.rules.document import CheckedText, CheckedTexts, Draft, PlacedFinding, placed_findings
from smarttestudo.ruler.topics.vocabulary import RobotTopics
from smarttestudo.rules.budget_findings import budget_findings
from smarttestudo.rules.rule_sets import known_types

_NAMED_ALREADY = frozenset({"absent-from-profile"})
_SAID_BY_LOADS = frozenset({"budget-fits"})


class SurroundingsRequest(Draft, frozen=True, kw_only=True):
    """A draft; ``recorded_topics`` are those of the recording that goes with it."""

    recorded_topics: tuple[str, ...] = ()


class SurroundingsAnswer(Struct, frozen=True, kw_only=True):
    """More findings on a draft; none for one with errors."""

    findings: tuple[PlacedFinding, ...]


@job("POST /api/surroundings", reads=True)
def surroundings(
    request: SurroundingsRequest, texts: CheckedTexts, robot_topics: RobotTopics
) -> SurroundingsAnswer:
    """Findings on the budget, and on topics that nobody knows."""
    checked = texts.checked(request)
    if checked.has_errors:
        return SurroundingsAnswer(findings=())
    known = {*robot_topics(), *request.recorded_topics}
    document = checked.document
    rules = {one.id for one in document.entries if isinstance(one.statement, Block)}
    on_budget = placed_findings(document, _on_budget(request, checked))
    return SurroundingsAnswer(
        findings=(
            *placed_findings(document, _unknown_topics(request, checked, known)),
            # What no rule is to blame for stands at the first statement, which is not to blame either.
            *(one if one.statement in rules else structs.replace(one, statement=None) for one in on_budget),
        )
    )


def _unknown_topics(draft: Draft, checked: CheckedText, known: set[str]) -> Iterator[Finding]:
    """Names that neither profile nor robot nor recording has; nothing where there is none of them."""
    profile = draft.profile()
    known |= set(profile.topics) if profile is not None else set()
    if not known:
        return
    named = {one.span for one in checked.findings if one.code in _NAMED_ALREADY}
    context = CheckContext(
        bag_topics=dict.fromkeys(known, ""), topics_lack="neither robot, recording nor profile has"
    )
    for finding in absent_from_bag.findings(read_rule_model([checked.document.result.file], context)):
        if finding.span not in named:
            yield replace(finding, severity=Severity.WARNING)


def _on_budget(draft: Draft, checked: CheckedText) -> Iterator[Finding]:
    profile = draft.profile()
    if profile is None:
        return
    domain = CheckContext(profile=profile).domain
    found = budget_findings(
        [checked.document.result.file], profile, resolve_topic, domain, known_types(None, profile)
    )
    yield from (one for one in found if one.code not in _SAID_BY_LOADS)
