# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Checks of blocks beside each other and beside the defaults."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence

from smarttestudo.checks import wording
from smarttestudo.checks.analysis import Clash, RedundantRate, Shadow, SharedBorder, wins_over
from smarttestudo.checks.rule_check import Found, RuleCheck
from smarttestudo.checks.rule_model import RuleModel
from smarttestudo.domain.finding import Fix, Severity, Span
from smarttestudo.domain.profile import Profile
from smarttestudo.language.boxes import Border
from smarttestudo.language.parser.tokens import TokenKind
from smarttestudo.language.resolved_rules import ResolvedRate


def _topic_twice(rules: RuleModel) -> Iterator[Found]:
    """A topic twice in one Then or Else."""
    for branch in rules.branches:
        first: dict[str, ResolvedRate] = {}
        for one in branch.written if len(branch.written) > len(branch.settings) else ():
            earlier = first.setdefault(one.topic, one)
            if earlier is not one:
                yield _repeated(one, earlier, "Else" if branch.is_else else "Then")


def _repeated(one: ResolvedRate, earlier: ResolvedRate, side: str) -> Found:
    is_same = one.rate is not None and one.rate == earlier.rate
    return Found(
        path=one.path,
        span=one.span,
        message=f"{one.topic} is already set at line {earlier.span.line} of this {side}",
        hint="keep one of the two",
        fix=Fix(span=one.span, replacement="", title="remove the repeated statement") if is_same else None,
    )


def _blocks_clash(rules: RuleModel) -> Iterator[Found]:
    """Blocks that can hold together at one priority and set different rates."""
    return map(_clash, rules.analysis.clashes)


def _clash(clash: Clash) -> Found:
    topic = clash.topics[0]
    here = clash.second.settings[topic]
    path = clash.second.block.path
    others = f" (and {wording.listed(clash.topics[1:])})" if len(clash.topics) > 1 else ""
    state = wording.state(clash.state)
    return Found(
        path=path,
        span=here.span,
        message=f"{wording.branch_name(clash.second)} sets {topic} to {here.rate}{others}, "
        f"{wording.branch_with_place(clash.first, seen_from=path)} to {clash.first.rate(topic)}, "
        f"and both hold {f'for example at {state}' if state else 'in some state'}",
        related=wording.places_in(path, [clash.first]),
        hint="the higher rate wins; give one block a higher Priority, or keep their conditions apart",
    )


def _block_shadowed(rules: RuleModel) -> Iterator[Found]:
    """Blocks that can never decide anything."""
    return map(_shadow, rules.analysis.shadows)


def _shadow(shadow: Shadow) -> Found:
    branch = shadow.branch
    path = branch.block.path
    rivals = [wording.branch_with_place(rival, seen_from=path) for rival in shadow.rivals]
    verb = "wins" if len(rivals) == 1 else "win"
    return Found(
        path=path,
        span=branch.written[0].span.to(branch.written[-1].span),
        message=f"{wording.branch_name(branch)} never decides a rate: wherever it holds, "
        f"{wording.listed(rivals)} {verb} by {wording.listed(_reasons(shadow))}",
        hint="give it a higher Priority, or remove it",
        related=wording.places_in(path, shadow.rivals),
    )


def _reasons(shadow: Shadow) -> list[str]:
    """Why the rivals win: a higher priority, else a higher rate, else the place in the file."""
    loser = shadow.branch
    reasons: set[str] = set()
    for rival in shadow.rivals:
        topics = [topic for topic in loser.settings if topic in rival.settings]
        if rival.block.priority > loser.block.priority:
            reasons.add("priority")
        elif any(
            rival.rate(topic) != loser.rate(topic) for topic in topics if wins_over(rival, loser, topic)
        ):
            reasons.add("rate")
        else:
            reasons.add("order")
    return [reason for reason in ("priority", "rate", "order") if reason in reasons]


def _no_margin(rules: RuleModel) -> Iterator[Found]:
    """Blocks that meet at a border without a margin."""
    settle_s = (rules.context.profile or Profile()).settle_s
    borders: dict[Border, SharedBorder] = {}
    for shared in rules.analysis.shared_borders:
        borders.setdefault(shared.border, shared)
    return (_border(shared, settle_s) for shared in borders.values())


def _border(shared: SharedBorder, settle_s: float) -> Found:
    topic = shared.topics[0]
    here = shared.second.settings[topic]
    path = shared.second.block.path
    border = f"{shared.border.signal} = {wording.number(shared.border.value)}"
    return Found(
        path=path,
        span=here.span,
        message=f"{wording.branch_name(shared.second)} and "
        f"{wording.branch_with_place(shared.first, seen_from=path)} meet at {border} without a margin: "
        f"there, noise moves {topic} between {shared.first.rate(topic)} and {here.rate}",
        hint=f"a lower rate waits {settle_s:g} s before it counts; raise settle_s in the profile if the "
        "robot stays on this border",
    )


def _rate_without_effect(rules: RuleModel) -> Iterator[Found]:
    """Rates of blocks that hold without them as well."""
    for _, alike in itertools.groupby(rules.analysis.redundant_rates, lambda one: one.branch.order):
        of_branch = list(alike)
        branch = of_branch[0].branch
        actions = branch.block.block.otherwise if branch.is_else else branch.block.block.then
        if len(of_branch) == len(actions):
            yield _redundant_branch(of_branch)
        else:
            yield from map(_redundant_rate, of_branch)


def _redundant_rate(one: RedundantRate) -> Found:
    setting = one.setting
    return Found(
        path=setting.path,
        span=setting.span,
        message=f"{setting.topic} is {setting.rate} without this as well, by the default "
        f"({_default_place(one)})",
        hint="remove it, or set another rate",
        fix=Fix(span=setting.span, replacement="", title="remove the rate without effect"),
    )


def _redundant_branch(rates: Sequence[RedundantRate]) -> Found:
    branch = rates[0].branch
    same = [f"{one.setting.topic} is {one.setting.rate} by default ({_default_place(one)})" for one in rates]
    return Found(
        path=branch.block.path,
        span=branch.written[0].span.to(branch.written[-1].span),
        message=f"{wording.sentence(wording.branch_name(branch))} changes nothing: {wording.listed(same)}",
        hint="remove it, or set other rates",
    )


def _default_place(one: RedundantRate) -> str:
    return wording.place(one.default.path, one.default.span, seen_from=one.setting.path)


def _block_disabled(rules: RuleModel) -> Iterator[Found]:
    """Blocks that are switched off."""
    for one in rules.disabled.blocks:
        whole = one.block.span
        end = whole.column + len(TokenKind.DISABLED.value)
        yield Found(
            path=one.path,
            span=Span(whole.line, whole.column, whole.line, end),
            message=f"{wording.sentence(wording.block_name(one.block))} is switched off",
            hint="it changes no rate, whatever holds; delete 'Disabled' to switch it on",
        )


BLOCKS_CLASH = RuleCheck(code="blocks-clash", severity=Severity.WARNING, find=_blocks_clash)

CHECKS = (
    RuleCheck(code="topic-twice", severity=Severity.ERROR, find=_topic_twice),
    BLOCKS_CLASH,
    RuleCheck(code="block-shadowed", severity=Severity.WARNING, find=_block_shadowed),
    RuleCheck(code="no-margin", severity=Severity.INFO, find=_no_margin),
    RuleCheck(code="rate-without-effect", severity=Severity.INFO, find=_rate_without_effect),
    RuleCheck(code="block-disabled", severity=Severity.INFO, find=_block_disabled),
)
