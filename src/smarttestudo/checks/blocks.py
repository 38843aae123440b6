# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Lint rules of blocks beside each other and beside the defaults."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence

from smarttestudo.checks import wording
from smarttestudo.checks.analysis import Clash, RedundantRate, Shadow, SharedBorder, wins_over
from smarttestudo.checks.lint_rule import Found, lint_rule
from smarttestudo.checks.rule_model import RuleModel
from smarttestudo.domain.finding import Fix, Severity, Span
from smarttestudo.domain.profile import Profile
from smarttestudo.language.boxes import Border
from smarttestudo.language.formatter import number_text
from smarttestudo.language.parser.lexer import TokenKind
from smarttestudo.language.resolved_rules import Branch, ResolvedRate
from smarttestudo.language.syntax_walks import sets_in


@lint_rule("topic-twice", Severity.ERROR)
def topic_twice(rules: RuleModel) -> Iterator[Found]:
    """A Then or Else sets one topic twice.

    One block can give a topic only one rate; a program cannot know which of the two was meant.
    """
    for branch in rules.branches:
        first: dict[str, ResolvedRate] = {}
        for rate in branch.written if len(branch.written) > len(branch.settings) else ():
            earlier = first.setdefault(rate.topic, rate)
            if earlier is not rate and not rate.is_by_pattern:
                yield _repeated(rate, earlier, "Else" if branch.is_else else "Then")


def _repeated(rate: ResolvedRate, earlier: ResolvedRate, side: str) -> Found:
    is_same = rate.rate is not None and rate.rate == earlier.rate
    return Found(
        path=rate.path,
        span=rate.span,
        message=f"{rate.topic} is already set at line {earlier.span.line} of this {side}",
        hint="keep one of the two",
        fix=Fix(span=rate.span, replacement="", title="remove the repeated statement") if is_same else None,
    )


@lint_rule("blocks-clash", Severity.WARNING)
def blocks_clash(rules: RuleModel) -> Iterator[Found]:
    """Two blocks of one priority can hold together and set a topic to different rates.

    The higher rate wins, whatever the order in the file. If the lower one was meant, the link carries
    more than planned. At most three clashes are shown for one block.
    """
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


@lint_rule("block-shadowed", Severity.WARNING)
def block_shadowed(rules: RuleModel) -> Iterator[Found]:
    """A block can never decide any of its topics.

    Wherever it holds, blocks of higher priority, or of the same priority and a higher rate, set all its
    topics too (among equals, the first block in the file is the one that decides). It has no effect,
    mostly because a number or a Priority is wrong.
    """
    return (_shadow(shadow) for shadow in rules.analysis.shadows if not _has_pattern(shadow.branch))


def _has_pattern(branch: Branch) -> bool:
    """Whether it sets topics of a kind, others of which may appear."""
    actions = branch.block.block.otherwise if branch.is_else else branch.block.block.then
    return any(rate.topic.is_pattern for rate in sets_in(actions))


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


@lint_rule("no-margin", Severity.INFO)
def no_margin(rules: RuleModel) -> Iterator[Found]:
    """Two blocks with different rates end and begin at the same number.

    A robot that stands on the border is alternately in one block and in the other, because a measurement
    has noise. The loop raises a rate at once and lowers it only after settle_s, so it does not flicker
    while the noise is faster than that. Where the robot stays on the border for long, a longer settle_s
    helps, or a strip between the blocks that is left to the default. Each border is shown once.
    """
    settle_s = (rules.context.profile or Profile()).settle_s
    borders: dict[Border, SharedBorder] = {}
    for shared in rules.analysis.shared_borders:
        borders.setdefault(shared.border, shared)
    return (_border(shared, settle_s) for shared in borders.values())


def _border(shared: SharedBorder, settle_s: float) -> Found:
    topic = shared.topics[0]
    here = shared.second.settings[topic]
    path = shared.second.block.path
    border = f"{shared.border.signal} = {number_text(shared.border.value)}"
    return Found(
        path=path,
        span=here.span,
        message=f"{wording.branch_name(shared.second)} and "
        f"{wording.branch_with_place(shared.first, seen_from=path)} meet at {border} without a margin: "
        f"there, noise moves {topic} between {shared.first.rate(topic)} and {here.rate}",
        hint=f"a lower rate waits {settle_s:g} s before it counts; raise settle_s in the profile if the "
        "robot stays on this border",
    )


@lint_rule("rate-without-effect", Severity.INFO)
def rate_without_effect(rules: RuleModel) -> Iterator[Found]:
    """A block sets a topic to the rate that it has by default, and overrules no other block there.

    The rate is the same without it, whatever is known or unknown. A changed default would make it matter,
    which may be meant; mostly another number was.
    """
    of_names = (one for one in rules.analysis.redundant_rates if not one.setting.is_by_pattern)
    for _, alike in itertools.groupby(of_names, lambda one: one.branch.order):
        of_branch = list(alike)
        branch = of_branch[0].branch
        actions = branch.block.block.otherwise if branch.is_else else branch.block.block.then
        if len(of_branch) == len(actions):
            yield _redundant_branch(of_branch)
        else:
            yield from map(_redundant_rate, of_branch)


def _redundant_rate(rate: RedundantRate) -> Found:
    setting = rate.setting
    return Found(
        path=setting.path,
        span=setting.span,
        message=f"{setting.topic} is {setting.rate} without this as well, by the default "
        f"({_default_place(rate)})",
        hint="remove it, or set another rate",
        fix=Fix(span=setting.span, replacement="", title="remove the rate without effect"),
    )


def _redundant_branch(rates: Sequence[RedundantRate]) -> Found:
    branch = rates[0].branch
    same = [
        f"{rate.setting.topic} is {rate.setting.rate} by default ({_default_place(rate)})" for rate in rates
    ]
    return Found(
        path=branch.block.path,
        span=branch.written[0].span.to(branch.written[-1].span),
        message=f"{wording.sentence(wording.branch_name(branch))} changes nothing: {wording.listed(same)}",
        hint="remove it, or set other rates",
    )


def _default_place(rate: RedundantRate) -> str:
    return wording.place(rate.default.path, rate.default.span, seen_from=rate.setting.path)


@lint_rule("block-disabled", Severity.INFO)
def block_disabled(rules: RuleModel) -> Iterator[Found]:
    """A block is switched off with Disabled.

    It is read and kept, and its names are checked, but no rate, bound or recording comes from it. Whoever
    counts on the block should know.
    """
    for block in rules.disabled.blocks:
        whole = block.block.span
        end = whole.column + len(TokenKind.DISABLED.value)
        yield Found(
            path=block.path,
            span=Span(whole.line, whole.column, whole.line, end),
            message=f"{wording.sentence(wording.block_name(block.block))} is switched off",
            hint="it changes no rate, whatever holds; delete 'Disabled' to switch it on",
        )
