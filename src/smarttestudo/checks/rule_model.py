# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Rule files as the checks read them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cache, partial
from itertools import chain
from typing import TypeVar

from smarttestudo.checks.analysis import Analysis, analyse
from smarttestudo.checks.context import CheckContext
from smarttestudo.checks.fixes import DefaultPlace, default_place
from smarttestudo.domain.dataclass import dataclass
from smarttestudo.domain.signal import Signal, Truth
from smarttestudo.domain.source import Span
from smarttestudo.language.normal_form import (
    InRegion,
    LastSeen,
    Resolve,
    check_form,
    merged,
    negation,
    over_states,
)
from smarttestudo.language.properties import PropertySpec
from smarttestudo.language.recall import Recall
from smarttestudo.language.region import Region
from smarttestudo.language.resolved_rules import (
    Branch,
    ResolvedBlock,
    ResolvedBound,
    ResolvedFloor,
    ResolvedRate,
    ResolvedRecord,
    ResolvedRules,
    resolve_rules,
)
from smarttestudo.language.syntax import (
    Action,
    Block,
    Check,
    RecordIncident,
    RuleFile,
    Statement,
    TopicName,
    bounds_in,
    checks_in,
    records_in,
    sets_in,
)

_T = TypeVar("_T")
_Relayed = ResolvedRate | ResolvedFloor


@dataclass(frozen=True, slots=True, kw_only=True)
class Mention:
    """A topic's name in a file."""

    path: str
    name: TopicName


@dataclass(frozen=True, slots=True, kw_only=True)
class CheckSite:
    """A CheckValue; ``spec`` is what is known about its property.

    ``truth`` says whether it holds for none (FALSE), all (TRUE) or some of the values of its property,
    ``latch`` is what a check with an ``Until`` remembers.
    """

    path: str
    signal: Signal
    spec: PropertySpec | None
    truth: Truth
    check: Check
    latch: LastSeen | None = None


class SiteReader:
    """Reads the checks of blocks."""

    def __init__(self, context: CheckContext, resolve: Resolve) -> None:
        self._resolve = resolve
        self._spec_of = cache(context.spec_of)
        self._values_of = cache(context.domain)

    def of(self, block: ResolvedBlock) -> tuple[CheckSite, ...]:
        """The checks of ``block`` in their order."""
        return tuple(self._sites(block))

    def _sites(self, block: ResolvedBlock) -> Iterator[CheckSite]:
        for check in checks_in(block.block.condition):
            signal = Signal(self._resolve(check.topic.text), check.property)
            form = check_form(check, signal)
            yield CheckSite(
                path=block.path,
                signal=signal,
                spec=self._spec_of(signal),
                truth=_truth(form, self._values_of(signal)),
                latch=form.signal if isinstance(form.signal, LastSeen) else None,
                check=check,
            )


def _truth(check: InRegion, values: Region) -> Truth:
    """The truth of ``check`` for every value; with an ``Until``, whatever was before."""
    latch = check.signal
    region = latch.on if isinstance(latch, LastSeen) else check.region
    if region.intersection(values).is_empty:
        return Truth.FALSE
    return Truth.TRUE if values.is_within(region) else Truth.UNKNOWN


@dataclass(frozen=True, slots=True, kw_only=True)
class RuleModel:
    """The rule files of one set with what is known beside them; everything in the order of the files.

    ``settings`` is every SetFrequency by topic, ``written_defaults`` the unconditional ones and ``defaults``
    those of them that count; ``floors`` are the KeepAtLeast that count, ``bounds`` every KeepWithin;
    ``relayed`` has the first SetFrequency or KeepAtLeast of each relayed topic, else the first KeepWithin,
    ``mentions`` the first mention of each topic at all; ``glued`` are, by file, the words that follow a
    keyword without a blank between. A branch that sets no rate is not among ``branches``, and ``recordings``
    is every Record. Conditions are over states. Of disabled blocks, only ``mentions``, ``disabled`` and
    ``disabled_checks`` tell. ``default_places`` are by file. ``recall`` has what is known of statements that
    the text before had as well.
    """

    context: CheckContext
    settings: Mapping[str, Sequence[ResolvedRate]]
    written_defaults: tuple[ResolvedRate, ...]
    defaults: Mapping[str, ResolvedRate]
    floors: Mapping[str, ResolvedFloor]
    relayed: Mapping[str, ResolvedRate | ResolvedFloor | ResolvedBound]
    mentions: Mapping[str, Mention]
    checks: tuple[CheckSite, ...]
    blocks: tuple[ResolvedBlock, ...]
    branches: tuple[Branch, ...]
    analysis: Analysis
    glued: Mapping[str, tuple[Span, ...]]
    bounds: tuple[ResolvedBound, ...]
    recordings: tuple[ResolvedRecord, ...]
    disabled: ResolvedRules
    disabled_checks: tuple[CheckSite, ...]
    default_places: Mapping[str, DefaultPlace | None]
    recall: Recall
    sites: SiteReader

    def of_block(self, block: ResolvedBlock, branches: Sequence[Branch]) -> RuleModel:
        """The same of one block alone, as far as checks read it that are about one block."""
        return replace(self, blocks=(block,), checks=self.sites.of(block), branches=tuple(branches))

    @property
    def bound_in_rules_only(self) -> Sequence[str]:
        """The topics that have bounds in blocks, and none that holds without a block."""
        always = {one.topic for one in self.bounds if one.branch is None}
        return tuple(dict.fromkeys(one.topic for one in self.bounds if one.topic not in always))


def read_rule_model(
    files: Sequence[RuleFile],
    context: CheckContext,
    recall: Recall | None = None,
) -> RuleModel:
    """The statements of ``files``, with the interval analysis of their conditions.

    ``recall`` is of a text of the same files in the same ``context``.
    """
    recall = recall or Recall()
    resolve = cache(context.resolve)
    rules = resolve_rules(files, resolve, recall=recall)
    disabled = resolve_rules(files, resolve, disabled=True, recall=recall)
    sites = SiteReader(context, resolve)
    blocks = recall.each("blocks over states", _block_over_states, rules.blocks)
    written = [one for one in rules.branches if one.written]
    by_order = {one.order: one for one in blocks}
    of_blocks = [by_order[one.block.order] for one in written]
    branches = recall.each("branches over states", _over_states, written, of_blocks)
    checks = recall.each("checks", sites.of, rules.blocks)
    disabled_checks = recall.each("disabled checks", sites.of, disabled.blocks)
    settings: dict[str, list[ResolvedRate]] = {}
    relayed: dict[str, _Relayed] = {}
    for firsts, by_topic in recall.runs("rates by topic", _by_topic, rules.rates):
        for topic, first in firsts.items():
            relayed.setdefault(topic, first)
        for topic, rates in by_topic.items():
            settings.setdefault(topic, []).extend(rates)
    return RuleModel(
        context=context,
        settings=settings,
        written_defaults=rules.written_defaults,
        defaults=rules.defaults,
        floors=rules.floors,
        relayed={**{one.topic: one for one in reversed(rules.bounds)}, **relayed},
        mentions=_mentions(files, resolve, recall),
        checks=tuple(chain.from_iterable(checks)),
        blocks=tuple(blocks),
        branches=tuple(branches),
        analysis=analyse(blocks, branches, rules.defaults, rules.floors, context, recall=recall),
        glued={file.path: file.glued for file in files if file.glued},
        bounds=rules.bounds,
        recordings=tuple(record for branch in rules.branches for record in branch.records),
        disabled=disabled,
        disabled_checks=tuple(chain.from_iterable(disabled_checks)),
        default_places={file.path: default_place(file) for file in files},
        recall=recall,
        sites=sites,
    )


def _block_over_states(block: ResolvedBlock) -> ResolvedBlock:
    return replace(block, form=merged(over_states(block.form)))


def _over_states(branch: Branch, block: ResolvedBlock) -> Branch:
    return replace(branch, block=block, form=negation(block.form) if branch.is_else else block.form)


def _firsts(parts: Iterable[Mapping[str, _T]]) -> Mapping[str, _T]:
    """The first value of each topic."""
    firsts: dict[str, _T] = {}
    for part in parts:
        for topic, one in part.items():
            firsts.setdefault(topic, one)
    return firsts


def _by_topic(
    rates: Sequence[_Relayed],
) -> tuple[Mapping[str, _Relayed], Mapping[str, Sequence[ResolvedRate]]]:
    """The first of each topic, and all that are no floors."""
    firsts: dict[str, _Relayed] = {}
    by_topic: dict[str, list[ResolvedRate]] = {}
    for one in rates:
        firsts.setdefault(one.topic, one)
        if isinstance(one, ResolvedRate):
            by_topic.setdefault(one.topic, []).append(one)
    return firsts, by_topic


def _mentions(files: Sequence[RuleFile], resolve: Resolve, recall: Recall) -> Mapping[str, Mention]:
    def first_mentions(path: str, statements: Sequence[Statement]) -> Mapping[str, Mention]:
        names = chain.from_iterable(map(_names_in, statements))
        return _firsts({resolve(name.text): Mention(path=path, name=name)} for name in names)

    return _firsts(
        part
        for number, file in enumerate(files)
        for part in recall.runs(("mentions", number), partial(first_mentions, file.path), file.statements)
    )


def _names_in(statement: Statement) -> Iterator[TopicName]:
    if not isinstance(statement, Block):
        yield statement.topic
        return
    yield from (check.topic for check in checks_in(statement.condition))
    for side in (statement.then, statement.otherwise):
        by_kind: tuple[Action, ...] = (*sets_in(side), *bounds_in(side), *records_in(side))
        for one in side if statement.is_disabled else by_kind:
            yield from one.topics if isinstance(one, RecordIncident) else (one.topic,)
