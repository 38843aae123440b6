# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Lint rules of bounds of the operator's picture, and of recordings of incidents."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache, partial

from smarttestudo.checks import wording
from smarttestudo.checks.lint_rule import Found, lint_rule
from smarttestudo.checks.property_doubt import Doubt, doubt_about, found_in
from smarttestudo.checks.rule_model import RuleModel
from smarttestudo.checks.wording import close_topic, write_topic
from smarttestudo.domain.finding import Fix, ProfileFix, Severity
from smarttestudo.domain.incident import DEFAULT_INCIDENT_MEMORY_MB
from smarttestudo.domain.rate import Tier
from smarttestudo.domain.signal import Signal
from smarttestudo.domain.units import BYTES_PER_KB, BYTES_PER_MB, NS_PER_S
from smarttestudo.language.properties import ARRIVAL_PROPERTIES, accuracy_properties_of, message_type
from smarttestudo.language.resolved_rules import ResolvedBound, ResolvedRecord


@lint_rule("unknown-bound", Severity.WARNING)
def unknown_bound(rules: RuleModel) -> Iterator[Found]:
    """A KeepWithin names a property that the messages of the topic do not have.

    What cannot be read cannot be compared: every message passes up to the topic's rate, and the bound
    saves nothing. Types come from the profile or a recording, as for checks.
    """
    doubt_of = cache(partial(doubt_about, context=rules.context, named=accuracy_properties_of))
    for bound in (*rules.bounds, *rules.disabled.bounds):
        doubt = _no_picture(bound.signal) or doubt_of(bound.signal) or _no_number(bound.signal, rules)
        if doubt is not None:
            yield found_in(bound.path, bound.statement.property_span, doubt)


def _no_picture(signal: Signal) -> Doubt | None:
    if signal.property not in ARRIVAL_PROPERTIES:
        return None
    return Doubt(
        message=f"{signal.property} is about when messages arrive, and not in them",
        hint="a floor keeps messages coming: KeepAtLeast and a rate",
        close=None,
    )


def _no_number(signal: Signal, rules: RuleModel) -> Doubt | None:
    """Doubt about a field inside a pose or twist, whose fields are known."""
    topic, known = signal.topic, rules.context.known_type(signal.topic)
    type_name = known or rules.context.type_of(topic) or ""
    found = message_type(type_name).part_at(signal.property)
    if found is None or found[0].has_number(found[1]):
        return None
    return Doubt(
        message=f"{type_name}, the type of {topic}, has no number {signal.property}"
        if known
        else f"{topic} is usually {type_name}, which has no number {signal.property}",
        hint="every message passes; write a field with a number, or position or orientation",
        close=None,
    )


@lint_rule("bound-in-rules-only", Severity.INFO, needs_all_statements=True)
def bound_in_rules_only(rules: RuleModel) -> Iterator[Found]:
    """A topic has a KeepWithin in rules, and none outside them.

    No bound is more than any bound. So while values are unknown the bound of a rule that may hold does
    not count, unless another one is known to: what the rate of the topic lets through passes. With a
    bound outside the rules the tightest of those that may hold counts.
    """
    first: dict[str, ResolvedBound] = {}
    for bound in rules.bounds:
        first.setdefault(bound.topic, bound)
    for topic in rules.bound_in_rules_only:
        default = rules.defaults.get(topic)
        if default is not None and not (default.rate is not None and default.rate.is_off):
            yield _not_bound_in_doubt(first[topic], rules)


def _not_bound_in_doubt(bound: ResolvedBound, rules: RuleModel) -> Found:
    statement, rate = bound.statement, rules.defaults[bound.topic].rate
    passes = "every message" if rate is not None and rate.is_full else "what its rate lets through"
    return Found(
        path=bound.path,
        span=statement.span,
        message=f"only rules bound {bound.topic}: while none of them is known to hold, also in doubt, "
        f"{passes} passes",
        hint=f"add KeepWithin {statement.topic.text} {statement.property} outside the rules for a bound that "
        "always holds",
    )


@lint_rule("bound-despite-off", Severity.WARNING)
def bound_despite_off(rules: RuleModel) -> Iterator[Found]:
    """Off is written for a topic that has a KeepWithin.

    The rate of a topic is the ceiling of what its bound may send. With Off nothing passes, and the
    operator's picture gets as wrong as it gets; every such message counts as a broken bound.
    """
    bounds = {one.topic: one for one in reversed(rules.bounds)}
    settings = ((bound, one) for topic, bound in bounds.items() for one in rules.settings.get(topic, ()))
    for bound, setting in settings:
        if setting.rate is not None and setting.rate.is_off:
            where = wording.place(bound.path, bound.statement.span, seen_from=setting.path)
            rate_span = setting.statement.rate.span
            yield Found(
                path=setting.path,
                span=rate_span,
                message=f"{setting.rate} stops {setting.topic} although KeepWithin ({where}) bounds its "
                f"{bound.statement.property}",
                hint="write a low rate, or Full to leave the rate to the bound",
                fix=Fix(span=rate_span, replacement="Full", title="leave the rate to the bound"),
            )


@lint_rule("bound-twice", Severity.WARNING)
def bound_twice(rules: RuleModel) -> Iterator[Found]:
    """A property is bound twice outside blocks, or twice in one Then or Else.

    The tighter bound counts, and the other one is never used: who changes that one later changes nothing.
    """
    first: dict[object, ResolvedBound] = {}
    for bound in rules.bounds:
        earlier = first.setdefault((bound.signal, bound.branch), bound)
        if earlier is not bound:
            yield Found(
                path=bound.path,
                span=bound.statement.span,
                message=f"{bound.signal} is already bound at line {earlier.statement.span.line}; the tighter "
                f"bound{_tightest(earlier, bound)} counts",
                hint="keep one of the two",
                fix=_remove_the_looser(earlier, bound),
            )


def _remove_the_looser(earlier: ResolvedBound, later: ResolvedBound) -> Fix | None:
    """Remove the looser one, as far as numbers say which that is."""
    first, second = earlier.statement.bound, later.statement.bound
    if isinstance(first, Tier) or isinstance(second, Tier):
        return None
    looser = later if second >= first else earlier
    return Fix(
        span=looser.statement.span, replacement="", title=f"remove the looser bound {looser.statement.text}"
    )


def _tightest(*bounds: ResolvedBound) -> str:
    """The text of the tightest, as far as numbers say which that is."""
    numbers = [(bound.statement.bound, bound.statement.text) for bound in bounds]
    known = [(bound, text) for bound, text in numbers if not isinstance(bound, Tier)]
    return f", {min(known, key=lambda each: each[0])[1]}," if len(known) == len(numbers) else ""


@lint_rule("bound-on-follower", Severity.WARNING)
def bound_on_follower(rules: RuleModel) -> Iterator[Found]:
    """A KeepWithin names a topic that the profile paces with another one.

    A topic that is paced with another one passes exactly the stamps that the other passed. Its own
    picture is not looked at, and may be off by more than the bound.
    """
    for bound in rules.bounds:
        leader = rules.context.topic(bound.topic).paced_with
        if leader is not None:
            yield Found(
                path=bound.path,
                span=bound.statement.span,
                message=f"{bound.topic} is paced with {leader}, so this bound has no effect",
                hint=f"bind {leader}, or remove paced_with from the profile",
                profile_fix=ProfileFix(
                    topic=bound.topic,
                    key="paced_with",
                    value=None,
                    title=f"no longer pace {bound.topic} with {leader}",
                ),
            )


_KB_PER_MB = BYTES_PER_MB / BYTES_PER_KB


@lint_rule("record-too-large", Severity.WARNING)
def record_too_large(rules: RuleModel) -> Iterator[Found]:
    """The time before the event that a Record keeps does not fit into memory.

    The largest topics then lack their oldest messages in the recording, and it says how many, unless the
    robot keeps the rest on disk (--incident-ring). Raw images are the usual cause; the compressed topic
    fits.
    """
    for recording in rules.recordings:
        kb_per_s = _kb_per_s(rules, recording)
        needed_mb = kb_per_s * recording.statement.before.ns / NS_PER_S / _KB_PER_MB
        if needed_mb > DEFAULT_INCIDENT_MEMORY_MB:
            fits_ms = int(1000 * DEFAULT_INCIDENT_MEMORY_MB * _KB_PER_MB / kb_per_s)
            fits = f"{fits_ms // 1000} s" if fits_ms >= 1000 else f"{fits_ms} ms"
            yield Found(
                path=recording.path,
                span=recording.statement.before.span,
                message=f"so much before takes {needed_mb:.0f} MB of the {DEFAULT_INCIDENT_MEMORY_MB} MB "
                "that are kept in memory",
                hint=f"Before {fits} would fit, or name fewer topics; --incident-memory gives more, "
                "--incident-ring keeps the rest on disk",
            )


def _kb_per_s(rules: RuleModel, record: ResolvedRecord) -> float:
    """The KB that its topics bring in a second, as far as the profile knows."""
    named = record.topics if record.statement.topics else {**rules.mentions, **rules.relayed}
    known = map(rules.context.topic, named)
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
    for recording in rules.recordings:
        for name in recording.statement.topics:
            topic = rules.context.resolve(name.text)
            if topic not in profile.topics and not name.is_pattern:
                yield Found(
                    path=recording.path,
                    span=name.span,
                    message=f"the profile has no {topic}, so that its recordings may lack it",
                    hint="is the name misspelt? else measure the profile again",
                    fix=write_topic(name, close_topic(topic, profile.topics)),
                )
