# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Rule files as the checks read them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache

from smarttestudo.checks.analysis import Analysis, analyse
from smarttestudo.checks.context import CheckContext
from smarttestudo.checks.written import (
    BlockSite,
    Branch,
    CheckSite,
    DisabledBlock,
    DisabledParts,
    Mention,
    WrittenBound,
    WrittenRate,
    WrittenRecord,
    conditions_in,
    rate_of,
)
from smarttestudo.domain.signal import Signal, Truth
from smarttestudo.domain.source import Span
from smarttestudo.language.normal_form import (
    InRegion,
    LastSeen,
    check_form,
    merged,
    negation,
    normal_form,
    over_states,
)
from smarttestudo.language.region import Region
from smarttestudo.language.syntax import (
    Block,
    Check,
    KeepAtLeast,
    KeepWithin,
    RecordIncident,
    RuleFile,
    SetFrequency,
    Statement,
    TopicName,
    bounds_in,
    checks_in,
    records_in,
    sets_in,
)


@dataclass(frozen=True, slots=True, kw_only=True)
class RuleModel:
    """The rule files of one set with what is known beside them; everything in the order of the files.

    ``settings`` is every SetFrequency, ``written_defaults`` the unconditional ones and ``defaults`` those of
    them that count; ``floors`` are the KeepAtLeast that count, ``bounds`` every KeepWithin; ``relayed`` has
    the first SetFrequency or KeepAtLeast of each relayed topic, else the first KeepWithin, ``mentions`` the
    first mention of each topic at all; ``glued`` are, by file, the words that follow a keyword without a
    blank between. A branch that sets no rate is not among ``branches``, and ``recordings`` is every Record.
    Of disabled blocks, only ``mentions`` and ``disabled`` tell. ``files`` are by their path.
    """

    context: CheckContext
    settings: tuple[WrittenRate, ...]
    written_defaults: tuple[WrittenRate, ...]
    defaults: Mapping[str, WrittenRate]
    floors: Mapping[str, WrittenRate]
    relayed: Mapping[str, WrittenRate | WrittenBound]
    mentions: Mapping[str, Mention]
    checks: tuple[CheckSite, ...]
    blocks: tuple[BlockSite, ...]
    branches: tuple[Branch, ...]
    analysis: Analysis
    glued: Mapping[str, tuple[Span, ...]]
    bounds: tuple[WrittenBound, ...]
    recordings: tuple[WrittenRecord, ...]
    disabled: DisabledParts
    files: Mapping[str, RuleFile]

    @property
    def bound_in_rules_only(self) -> Sequence[str]:
        """The topics that have bounds in blocks, and none that holds without a block."""
        always = {one.topic for one in self.bounds if one.branch is None}
        return tuple(dict.fromkeys(one.topic for one in self.bounds if one.topic not in always))


def read_rule_model(files: Sequence[RuleFile], context: CheckContext) -> RuleModel:
    """The statements of ``files``, with the interval analysis of their conditions."""
    reader = _Reader(context)
    for file in files:
        reader.files[file.path] = file
        if file.glued:
            reader.glued[file.path] = file.glued
        for statement in file.statements:
            reader.add(file.path, statement)
    return reader.rule_model()


class _Reader:
    def __init__(self, context: CheckContext) -> None:
        self._context = context
        self._full_name = cache(context.resolve)
        self._spec_of = cache(context.spec_of)
        self._values_of = cache(context.domain)
        self._settings: list[WrittenRate] = []
        self._defaults: list[WrittenRate] = []
        self._floors: dict[str, WrittenRate] = {}
        self._relayed: dict[str, WrittenRate] = {}
        self._mentions: dict[str, Mention] = {}
        self._checks: list[CheckSite] = []
        self._blocks: list[BlockSite] = []
        self._branches: list[Branch] = []
        self._bounds: list[WrittenBound] = []
        self._recordings: list[WrittenRecord] = []
        self._disabled_blocks: list[DisabledBlock] = []
        self._disabled_checks: list[CheckSite] = []
        self._disabled_bounds: list[WrittenBound] = []
        self.glued: dict[str, tuple[Span, ...]] = {}
        self.files: dict[str, RuleFile] = {}

    def add(self, path: str, statement: Statement) -> None:
        match statement:
            case Block(is_disabled=True):
                self._add_disabled(path, statement)
            case Block():
                self._add_block(path, statement)
            case SetFrequency():
                self._defaults.append(self._setting(path, statement))
            case KeepWithin():
                self._add_bounds(path, (statement,), None)
            case KeepAtLeast():
                floor = self._rate(path, statement)
                highest = self._floors.setdefault(floor.topic, floor)
                if highest.rate is not None and floor.rate is not None and highest.rate < floor.rate:
                    self._floors[floor.topic] = floor

    def rule_model(self) -> RuleModel:
        defaults = {one.topic: one for one in self._defaults}
        return RuleModel(
            context=self._context,
            settings=tuple(self._settings),
            written_defaults=tuple(self._defaults),
            defaults=defaults,
            floors=self._floors,
            relayed={**self._first_bounds(), **self._relayed},
            mentions=self._mentions,
            checks=tuple(self._checks),
            blocks=tuple(self._blocks),
            branches=tuple(self._branches),
            analysis=analyse(self._blocks, self._branches, defaults, self._floors, self._context),
            glued=self.glued,
            bounds=tuple(self._bounds),
            recordings=tuple(self._recordings),
            disabled=DisabledParts(
                blocks=tuple(self._disabled_blocks),
                checks=tuple(self._disabled_checks),
                bounds=tuple(self._disabled_bounds),
            ),
            files=self.files,
        )

    def _first_bounds(self) -> Mapping[str, WrittenBound]:
        return {one.topic: one for one in reversed(self._bounds)}

    def _add_disabled(self, path: str, block: Block) -> None:
        self._disabled_blocks.append(DisabledBlock(path=path, block=block))
        self._disabled_checks += (self._check(path, one) for one in checks_in(block.condition))
        for one in (*block.then, *block.otherwise):
            for name in one.topics if isinstance(one, RecordIncident) else (one.topic,):
                topic = self._resolve(path, name)
                if isinstance(one, KeepWithin):
                    bound = WrittenBound(path=path, topic=topic, statement=one, branch=None)
                    self._disabled_bounds.append(bound)

    def _add_block(self, path: str, block: Block) -> None:
        form = merged(over_states(normal_form(block.condition, self._full_name)))
        written = BlockSite(order=len(self._blocks), path=path, block=block, form=form)
        self._blocks.append(written)
        for part in conditions_in(block.condition):
            if isinstance(part, Check):
                self._checks.append(self._check(path, part))
        for actions, is_else in ((block.then, False), (block.otherwise, True)):
            self._add_branch(written, sets_in(actions), is_else=is_else)
            self._add_bounds(path, bounds_in(actions), (written.order, is_else))
            self._add_recordings(written, records_in(actions), is_else=is_else)

    def _add_bounds(
        self, path: str, statements: Iterable[KeepWithin], branch: tuple[int, bool] | None
    ) -> None:
        for one in statements:
            topic = self._resolve(path, one.topic)
            self._bounds.append(WrittenBound(path=path, topic=topic, statement=one, branch=branch))

    def _add_recordings(
        self, block: BlockSite, statements: Iterable[RecordIncident], *, is_else: bool
    ) -> None:
        for record in statements:
            topics = tuple(self._resolve(block.path, name) for name in record.topics)
            self._recordings.append(WrittenRecord(block=block, record=record, topics=topics, is_else=is_else))

    def _check(self, path: str, check: Check) -> CheckSite:
        signal = Signal(self._resolve(path, check.topic), check.property)
        form = check_form(check, signal)
        return CheckSite(
            path=path,
            signal=signal,
            spec=self._spec_of(signal),
            truth=_truth(form, self._values_of(signal)),
            latch=form.signal if isinstance(form.signal, LastSeen) else None,
            check=check,
        )

    def _add_branch(self, block: BlockSite, statements: Iterable[SetFrequency], *, is_else: bool) -> None:
        written = tuple(self._setting(block.path, statement) for statement in statements)
        if not written:
            return
        branch = Branch(
            order=len(self._branches),
            block=block,
            is_else=is_else,
            form=negation(block.form) if is_else else block.form,
            written=written,
            settings={one.topic: one for one in written},
        )
        self._branches.append(branch)

    def _setting(self, path: str, statement: SetFrequency) -> WrittenRate:
        setting = self._rate(path, statement)
        self._settings.append(setting)
        return setting

    def _rate(self, path: str, statement: SetFrequency | KeepAtLeast) -> WrittenRate:
        topic = self._resolve(path, statement.topic)
        written = WrittenRate(path=path, topic=topic, statement=statement, rate=rate_of(statement.rate))
        self._relayed.setdefault(topic, written)
        return written

    def _resolve(self, path: str, name: TopicName) -> str:
        topic = self._full_name(name.text)
        if topic not in self._mentions:
            self._mentions[topic] = Mention(path=path, name=name)
        return topic


def _truth(check: InRegion, values: Region) -> Truth:
    """The truth of ``check`` for every value; with an ``Until``, whatever was before."""
    latch = check.signal
    region = latch.on if isinstance(latch, LastSeen) else check.region
    if region.intersection(values).is_empty:
        return Truth.FALSE
    return Truth.TRUE if values.is_within(region) else Truth.UNKNOWN
