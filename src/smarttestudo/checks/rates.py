# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Lint rules of rates: defaults, floors and levels."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from itertools import chain

from smarttestudo.checks import wording
from smarttestudo.checks.analysis import Gap
from smarttestudo.checks.lint_rule import Found, lint_rule
from smarttestudo.checks.rule_model import RuleModel
from smarttestudo.checks.wording import new_default
from smarttestudo.domain.finding import Fix, Severity
from smarttestudo.domain.rate import Tier
from smarttestudo.language.resolved_rules import ResolvedFloor, ResolvedRate
from smarttestudo.language.syntax_walks import (
    bound_span,
)
from smarttestudo.pacing.coded_video import may_be_coded_video
from smarttestudo.pacing.sample import is_patch

_USUAL_LOW_HZ = 1.0


@lint_rule("tier-without-rate", Severity.ERROR)
def tier_without_rate(rules: RuleModel) -> Iterator[Found]:
    """A quality level is written and no profile gives it a rate, or an accuracy in a KeepWithin.

    A level stands for the rate that the optimizer finds for it within the budget, from the profile's
    sizes and levels. Without a profile its rate is unknown. The same is true of accuracies.
    """
    if rules.context.profile is not None:
        return
    for setting, tier in _tiers(chain.from_iterable(rules.settings.values())):
        yield Found(
            path=setting.path,
            span=setting.statement.rate.span,
            message=f"{tier.value} has no rate without a profile",
            hint=f"write a rate in Hz, or {rules.context.way_to_profile}",
        )
    for bound in rules.bounds:
        level = bound.statement.bound
        if isinstance(level, Tier):
            yield Found(
                path=bound.path,
                span=bound_span(bound.statement),
                message=f"{level.value} has no accuracy without a profile",
                hint=f"write a number, or {rules.context.way_to_profile}",
            )


def _tiers(rates: Iterable[ResolvedRate]) -> Iterator[tuple[ResolvedRate, Tier]]:
    """Rates among ``rates`` that are tiers."""
    return ((rate, tier) for rate in rates if isinstance(tier := rate.statement.highest.value, Tier))


@lint_rule("two-defaults", Severity.WARNING)
def two_defaults(rules: RuleModel) -> Iterator[Found]:
    """A topic has two defaults, in one file or in two of a set.

    Only the last one counts; editing the other one changes nothing.
    """
    for default in rules.written_defaults:
        last = rules.defaults[default.topic]
        if default is not last and not default.is_by_pattern:
            where = wording.place(last.path, last.span, seen_from=default.path)
            yield Found(
                path=default.path,
                span=default.span,
                message=f"this default of {default.topic} is overridden by that of {where}",
                hint="the last default counts; remove this one",
                fix=Fix(span=default.span, replacement="", title="remove the overridden default"),
            )


@lint_rule("missing-default", Severity.WARNING, needs_all_statements=True)
def missing_default(rules: RuleModel) -> Iterator[Found]:
    """A block sets or bounds a topic that has neither a default nor a block for every case.

    Where no block sets it, or bounds it, and while the values that the blocks read are unknown, the topic
    is Full: every message travels. For a camera that can be more than the whole link.
    """
    yield from (_not_set_by_a_block(gap, rules) for gap in rules.analysis.gaps)
    yield from (
        _no_default(topic, "no block bounds it", rules)
        for topic in rules.bound_in_rules_only
        if not rules.settings.get(topic)
    )


def _not_set_by_a_block(gap: Gap, rules: RuleModel) -> Found:
    state = wording.state(gap.state or {})
    return _no_default(gap.topic, f"no block sets it{f', for example at {state},' if state else ''}", rules)


def _no_default(topic: str, where: str, rules: RuleModel) -> Found:
    first = rules.relayed[topic]
    rate, says = _low_rate(topic, rules)
    return Found(
        path=first.path,
        span=first.statement.topic.span,
        message=f"{topic} has no default: it is Full{_cost_of_full(topic, rules)} where {where} and while "
        "values are unknown",
        hint=f"add a default: SetFrequency {first.statement.topic.text} and a rate"
        f"{f'; testudo optimize adds {rate}{says}' if says else ''}",
        fix=new_default(rules.default_places.get(first.path), first.statement.topic.text, rate, says),
    )


def _low_rate(topic: str, rules: RuleModel) -> tuple[str, str]:
    """A default that costs little, and what it means: the level that optimizing adds, if that is known."""
    profile, known = rules.context.profile, rules.context.topic(topic)
    has_budget = profile is not None and profile.budget_kb_per_s is not None
    if has_budget and known.tiers_hz is not None and known.message_kb is not None:
        return Tier.UNACCEPTABLE.value, f", up to {known.tiers_hz[0]:g} Hz"
    if is_patch(rules.context.type_of(topic) or ""):
        return "Full", ""
    in_rules = {rate.rate.hz for rate in rules.settings.get(topic, ()) if rate.rate is not None}
    return "2" if _USUAL_LOW_HZ in in_rules else f"{_USUAL_LOW_HZ:g}", ""


def _cost_of_full(topic: str, rules: RuleModel) -> str:
    known = rules.context.topic(topic)
    if known.message_kb is None or known.source_hz is None:
        return ""
    kb_per_s = known.message_kb * known.source_hz
    return f" ({kb_per_s:.{0 if kb_per_s >= 100 else 1}f} KB/s)"


def _floored(rules: RuleModel) -> Iterator[tuple[ResolvedFloor, ResolvedRate]]:
    """Every SetFrequency of a topic with a floor."""
    return (
        (floor, setting) for topic, floor in rules.floors.items() for setting in rules.settings.get(topic, ())
    )


@lint_rule("rate-below-floor", Severity.WARNING)
def rate_below_floor(rules: RuleModel) -> Iterator[Found]:
    """A rate lies below the topic's KeepAtLeast.

    No rate goes below a floor, so the topic gets the floor's rate and the written one never occurs.
    """
    for floor, setting in _floored(rules):
        if setting.rate is not None and setting.rate.yields_to_floor and setting.rate.hz < floor.rate.hz:
            where = wording.place(floor.path, floor.span, seen_from=setting.path)
            yield Found(
                path=setting.path,
                span=setting.statement.rate.span,
                message=f"{setting.rate} is below the floor of {setting.topic}: KeepAtLeast ({where}) "
                f"raises it to {floor.rate}",
                hint="write the floor's rate here, or lower the floor",
                fix=Fix(
                    span=setting.statement.rate.span,
                    replacement=floor.statement.rate.text,
                    title="write the rate that it has anyway",
                ),
            )


@lint_rule("off-despite-floor", Severity.WARNING)
def off_despite_floor(rules: RuleModel) -> Iterator[Found]:
    """Off is written for a topic that has a KeepAtLeast.

    Off is the only rate that goes below a floor: who relies on the KeepAtLeast then receives nothing.
    """
    for floor, setting in _floored(rules):
        if setting.rate is not None and not setting.rate.yields_to_floor:
            where = wording.place(floor.path, floor.span, seen_from=setting.path)
            yield Found(
                path=setting.path,
                span=setting.statement.rate.span,
                message=f"Off stops {setting.topic} although KeepAtLeast ({where}) keeps it at {floor.rate}",
                hint="write 0 for the floor's rate, or remove the KeepAtLeast",
                fix=Fix(
                    span=setting.statement.rate.span,
                    replacement=floor.statement.rate.text,
                    title="write the floor's rate",
                ),
            )


def _thinned(rules: RuleModel) -> Iterator[tuple[ResolvedRate, str]]:
    """The first statement of each topic by which not all of its messages pass, and the topic's known type."""
    for topic, written in rules.settings.items():
        known_type = rules.context.known_type(topic)
        source_hz = rules.context.topic(topic).source_hz or math.inf
        thinning = (setting for setting in written if setting.rate is None or 0 < setting.rate.hz < source_hz)
        first = next(thinning, None)
        if known_type is not None and first is not None:
            yield first, known_type


def _rate_text(rate: ResolvedRate) -> str:
    level = rate.statement.highest.value
    return level.value if isinstance(level, Tier) else str(rate.rate)


@lint_rule("video-in-groups", Severity.INFO)
def video_in_groups(rules: RuleModel) -> Iterator[Found]:
    """Coded video is relayed at a rate below that of its source.

    All frames but the key frames are differences to the frame before, so a relay passes whole groups: a
    key frame, what follows it while the rate allows, and then nothing until the next key frame. The
    picture moves, rests and moves again. Of groups that last more than two seconds, less passes than the
    rate. Where no key frame is found, because the coder is not known, all passes.
    """
    for setting, type_name in _thinned(rules):
        if may_be_coded_video(type_name, setting.topic):
            source_hz = rules.context.topic(setting.topic).source_hz
            shown = f"at {_rate_text(setting)} it shows only the beginning of each group"
            if source_hz is not None and setting.rate is not None:
                share = f"{100 * setting.rate.hz / source_hz:.0f} %"
                shown = f"at {setting.rate.hz:g} of {source_hz:g} Hz it shows the first {share} of each group"
            yield Found(
                path=setting.path,
                span=setting.statement.rate.span,
                message=f"{setting.topic} is coded video ({type_name}): {shown}",
                hint="a group is a key frame with the differences after it; for an even picture have the "
                "encoder send a key frame once or twice a second, or fewer frames",
            )


@lint_rule("video-paced-with", Severity.INFO)
def video_paced_with(rules: RuleModel) -> Iterator[Found]:
    """The profile paces coded video with another topic.

    A relay passes coded video by whole groups, which begin elsewhere than those of another camera. So
    paced_with has no effect on it. Another topic, such as its camera_info, may be paced with coded video.
    """
    for topic, first in rules.relayed.items():
        leader, known_type = rules.context.topic(topic).paced_with, rules.context.known_type(topic)
        if leader is not None and known_type is not None and may_be_coded_video(known_type, topic):
            yield Found(
                path=first.path,
                span=first.statement.topic.span,
                message=f"{topic} is coded video ({known_type}), which is not paced with {leader}",
                hint="its groups begin elsewhere; remove paced_with from the profile",
            )


@lint_rule("patches-thinned", Severity.WARNING)
def patches_thinned(rules: RuleModel) -> Iterator[Found]:
    """A topic is relayed at a rate whose messages change a part of what was sent before.

    An update of a map or of a scene is about what changed since the one before. Where one is left out,
    what the operator sees stays wrong until somebody sends the whole anew. The rate is obeyed all the
    same; without one such a topic is Full.
    """
    for setting, type_name in _thinned(rules):
        if is_patch(type_name):
            yield Found(
                path=setting.path,
                span=setting.statement.rate.span,
                message=f"{setting.topic} has changes to what was sent before ({type_name}): at "
                f"{_rate_text(setting)} some are left out, and what is shown stays wrong",
                hint="write Full, or in its place relay the topic that has the whole",
                fix=Fix(span=setting.statement.rate.span, replacement="Full", title="relay it whole"),
            )
