# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Lint rules of recordings of incidents."""

from __future__ import annotations

from collections.abc import Iterator

from smarttestudo.checks.fixes import close_topic, write_topic
from smarttestudo.checks.lint_rule import Found, lint_rule
from smarttestudo.checks.rule_model import RuleModel
from smarttestudo.domain.finding import Severity
from smarttestudo.domain.incident import DEFAULT_INCIDENT_MEMORY_MB
from smarttestudo.domain.units import BYTES_PER_KB, BYTES_PER_MB, NS_PER_S
from smarttestudo.language.resolved_rules import ResolvedRecord

_KB_PER_MB = BYTES_PER_MB / BYTES_PER_KB


@lint_rule("record-too-large", Severity.WARNING)
def record_too_large(rules: RuleModel) -> Iterator[Found]:
    """The time before the event that a Record keeps does not fit into memory.

    The largest topics then lack their oldest messages in the recording, and it says how many, unless the
    robot keeps the rest on disk (--incident-ring). Raw images are the usual cause; the compressed topic
    fits.
    """
    for one in rules.recordings:
        kb_per_s = _kb_per_s(rules, one)
        needed_mb = kb_per_s * one.statement.before.ns / NS_PER_S / _KB_PER_MB
        if needed_mb > DEFAULT_INCIDENT_MEMORY_MB:
            fits_ms = int(1000 * DEFAULT_INCIDENT_MEMORY_MB * _KB_PER_MB / kb_per_s)
            fits = f"{fits_ms // 1000} s" if fits_ms >= 1000 else f"{fits_ms} ms"
            yield Found(
                path=one.path,
                span=one.statement.before.span,
                message=f"so much before takes {needed_mb:.0f} MB of the {DEFAULT_INCIDENT_MEMORY_MB} MB "
                "that are kept in memory",
                hint=f"Before {fits} would fit, or name fewer topics; --incident-memory gives more, "
                "--incident-ring keeps the rest on disk",
            )


def _kb_per_s(rules: RuleModel, one: ResolvedRecord) -> float:
    """The KB that its topics bring in a second, as far as the profile knows."""
    known = (rules.context.topic(topic) for topic in one.topics or rules.mentions)
    return sum((topic.message_kb or 0.0) * (topic.source_hz or 0.0) for topic in known)


@lint_rule("record-unpublished", Severity.WARNING)
def record_unpublished(rules: RuleModel) -> Iterator[Found]:
    """A Record names a topic that the profile does not contain.

    Usually the name is misspelt, and the one topic that would explain an incident is not in it.
    """
    profile = rules.context.profile
    if profile is None or not profile.topics or rules.context.bag_topics is not None:
        # Topics that a recording lacks are told all at once, see absent-from-bag.
        return
    for one in rules.recordings:
        for name, topic in zip(one.statement.topics, one.topics, strict=True):
            if topic not in profile.topics:
                yield Found(
                    path=one.path,
                    span=name.span,
                    message=f"the profile has no {topic}, so that its recordings may lack it",
                    hint="is the name misspelt? else measure the profile again",
                    fix=write_topic(name, close_topic(topic, profile.topics)),
                )
