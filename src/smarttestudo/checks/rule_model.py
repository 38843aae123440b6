# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Rule files as lint rules read them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache

from smarttestudo.checks.analysis import Analysis, analyse
from smarttestudo.checks.context import CheckContext
from smarttestudo.checks.wording import DefaultPlace, default_place
from smarttestudo.domain.finding import Span
from smarttestudo.domain.signal import Truth
from smarttestudo.language.normal_form import Resolve, merged, negation, over_states
from smarttestudo.language.resolved_rules import (
    Branch,
    ResolvedBlock,
    ResolvedBound,
    ResolvedCheck,
    ResolvedFloor,
    ResolvedPattern,
    ResolvedRate,
    ResolvedRecord,
    ResolvedRules,
    resolve_rules,
)
from smarttestudo.language.syntax import (
    RuleFile,
    TopicName,
)
from smarttestudo.language.syntax_walks import (
    topic_names_in,
)
from smarttestudo.language.text_region import SetOfValues, common, is_part_of


@dataclass(frozen=True, slots=True, kw_only=True)
class Mention:
    """A topic's name in a file."""

    path: str
    name: TopicName


@dataclass(frozen=True, slots=True, kw_only=True)
class RuleModel:
    """The rule files of one set with what is known beside them; everything in the order of the files.

    ``settings`` is every SetFrequency by topic, ``written_defaults`` the unconditional ones and ``defaults``
    those of them that count; ``floors`` are the KeepAtLeast that count, ``bounds`` every KeepWithin;
    ``relayed`` has the first SetFrequency or KeepAtLeast of each relayed topic, else the first KeepWithin,
    ``mentions`` the first mention of each topic by name, ``patterns`` all that stands for topics of a kind;
    ``glued`` are, by file, the words that follow a keyword without a blank between. A branch that sets no
    rate is not among ``branches``; ``acting`` are those that set parameters, call or notify, and
    ``recordings`` is every Record. Conditions are over states. Of disabled blocks, only ``mentions``,
    ``disabled`` and ``disabled_checks`` tell. ``default_places`` are by file.
    """

    context: CheckContext
    settings: Mapping[str, Sequence[ResolvedRate]]
    written_defaults: tuple[ResolvedRate, ...]
    defaults: Mapping[str, ResolvedRate]
    floors: Mapping[str, ResolvedFloor]
    relayed: Mapping[str, ResolvedRate | ResolvedFloor | ResolvedBound]
    mentions: Mapping[str, Mention]
    patterns: tuple[ResolvedPattern, ...]
    checks: tuple[ResolvedCheck, ...]
    blocks: tuple[ResolvedBlock, ...]
    branches: tuple[Branch, ...]
    analysis: Analysis
    glued: Mapping[str, tuple[Span, ...]]
    bounds: tuple[ResolvedBound, ...]
    recordings: tuple[ResolvedRecord, ...]
    acting: tuple[Branch, ...]
    disabled: ResolvedRules
    disabled_checks: tuple[ResolvedCheck, ...]
    default_places: Mapping[str, DefaultPlace | None]

    @property
    def bound_in_rules_only(self) -> Sequence[str]:
        """The topics that have bounds in blocks, and none that holds without a block."""
        always = {bound.topic for bound in self.bounds if bound.branch is None}
        return tuple(dict.fromkeys(bound.topic for bound in self.bounds if bound.topic not in always))


def read_rule_model(files: Sequence[RuleFile], context: CheckContext) -> RuleModel:
    """The statements of ``files``, with the interval analysis of their conditions."""
    resolve = cache(context.resolve)
    rules = resolve_rules(files, resolve, context.types)
    disabled = resolve_rules(files, resolve, context.types, disabled=True)
    blocks = [replace(block, form=merged(over_states(block.form))) for block in rules.blocks]
    branches = [
        _over_states(branch, blocks[branch.block.order]) for branch in rules.branches if branch.written
    ]
    settings: dict[str, list[ResolvedRate]] = {}
    relayed: dict[str, ResolvedRate | ResolvedFloor] = {}
    for rate in rules.rates:
        relayed.setdefault(rate.topic, rate)
        if isinstance(rate, ResolvedRate):
            settings.setdefault(rate.topic, []).append(rate)
    return RuleModel(
        context=context,
        settings=settings,
        written_defaults=rules.written_defaults,
        defaults=rules.defaults,
        floors=rules.floors,
        relayed={**{bound.topic: bound for bound in reversed(rules.bounds)}, **relayed},
        mentions=_mentions(files, resolve),
        patterns=rules.patterns,
        checks=_checks(rules),
        blocks=tuple(blocks),
        branches=tuple(branches),
        analysis=analyse(blocks, branches, rules.defaults, rules.floors, context),
        glued={file.path: file.glued for file in files if file.glued},
        bounds=rules.bounds,
        recordings=tuple(record for branch in rules.branches for record in branch.records),
        acting=tuple(
            _over_states(branch, blocks[branch.block.order]) for branch in rules.branches if branch.acts
        ),
        disabled=disabled,
        disabled_checks=_checks(disabled),
        default_places={file.path: default_place(file) for file in files},
    )


def check_truth(check: ResolvedCheck, values: SetOfValues) -> Truth:
    """Whether ``check`` holds for none (FALSE), all (TRUE) or some of ``values``, whatever was before."""
    region = check.region if check.latch is None else check.latch.on
    if common(region, values).is_empty:
        return Truth.FALSE
    return Truth.TRUE if is_part_of(values, region) else Truth.UNKNOWN


def _over_states(branch: Branch, block: ResolvedBlock) -> Branch:
    return replace(branch, block=block, form=negation(block.form) if branch.is_else else block.form)


def _checks(rules: ResolvedRules) -> tuple[ResolvedCheck, ...]:
    return tuple(check for block in rules.blocks for check in block.checks)


def _mentions(files: Sequence[RuleFile], resolve: Resolve) -> Mapping[str, Mention]:
    mentions: dict[str, Mention] = {}
    for file in files:
        names = (name for statement in file.statements for name in topic_names_in(statement))
        for name in names:
            topic = resolve(name.text)
            if topic not in mentions:
                mentions[topic] = Mention(path=file.path, name=name)
    return mentions
