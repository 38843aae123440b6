# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What rule files mean together, before any value is known."""

from __future__ import annotations

from dataclasses import replace

import pytest
from hypothesis import given, settings

from language.rule_strategies import rule_files
from smarttestudo.domain.errors import RuleFileError
from smarttestudo.domain.names import resolve_topic
from smarttestudo.domain.rate import Rate
from smarttestudo.domain.signal import Signal
from smarttestudo.language.parser import parse
from smarttestudo.language.rule_set import RuleSet, compile_rules
from smarttestudo.language.syntax import Block, KeepWithin, RuleFile, SetFrequency


def file(text: str, path: str = "rules.adirf") -> RuleFile:
    parsed = parse(text, path)
    assert not parsed.findings
    return parsed.file


def rules(*texts: str) -> RuleSet:
    return compile_rules([file(text) for text in texts], resolve_topic)


def test_the_last_default_and_the_highest_floor_of_a_topic_count_across_files() -> None:
    rule_set = rules(
        "begin SetFrequency /a 1 KeepAtLeast /a 3 end", "begin\nSetFrequency /a 2 KeepAtLeast /a 2 end"
    )
    assert rule_set.defaults == {"/a": Rate(2.0)}
    assert rule_set.default_lines == {"/a": 2}
    assert rule_set.floors_hz == {"/a": 3.0}


def test_topics_of_defaults_floors_bounds_and_blocks_are_relayed_and_those_of_checks_only_read() -> None:
    rule_set = rules(
        """
        begin
        KeepWithin /bound position 0.1
        KeepAtLeast /floor 1
        SetFrequency /default 3
        If CheckValue /read x > 1 Then SetFrequency /set 2 KeepWithin /kept position 0.1
        end
        """
    )
    assert rule_set.relayed == ("/default", "/floor", "/bound", "/set", "/kept")
    assert rule_set.signals == {Signal("/read", "x")}


class OfTiers:
    """Any rate and bound for a tier."""

    def tier_rate(self, _statement: SetFrequency, _path: str, /) -> Rate:
        return Rate(7.0)

    def tier_bound(self, _statement: KeepWithin, _path: str, /) -> float:
        return 0.7


@given(rule_files())
@settings(max_examples=60)
def test_a_disabled_block_means_what_no_block_means(drawn: RuleFile) -> None:
    without = [
        replace(part, statements=tuple(one for one in part.statements if not is_disabled(one)))
        for part in drawn.collections
    ]
    left = replace(drawn, collections=tuple(without))
    assert compile_rules([drawn], resolve_topic, OfTiers()) == compile_rules([left], resolve_topic, OfTiers())


def is_disabled(statement: object) -> bool:
    return isinstance(statement, Block) and statement.is_disabled


def test_a_topic_that_only_a_disabled_block_sets_is_not_relayed() -> None:
    block = "If CheckValue /odom x > 1 Then SetFrequency /scan Desirable EndIf"
    rule_set = rules(f"begin SetFrequency /odom 1 Disabled {block} end")
    assert rule_set.relayed == ("/odom",)
    assert rule_set.signals == frozenset()


def test_an_else_is_a_block_of_its_own_at_the_same_line() -> None:
    rule_set = rules(
        "begin\n"
        'Rule "near" Priority 3 If CheckValue /scan x < 1 Then SetFrequency /a 2 Else SetFrequency /b 4\n'
        "end"
    )
    near, far = rule_set.blocks
    assert (near.order, near.label, near.priority, near.line) == (0, "near", 3, 2)
    assert (far.order, far.label, far.priority, far.line) == (1, "near (Else)", 3, 2)
    assert (near.rates, far.rates) == ({"/a": Rate(2.0)}, {"/b": Rate(4.0)})


def test_relative_names_are_resolved_in_checks_and_settings_alike() -> None:
    parsed = file("begin SetFrequency odom 1 If CheckValue odom x > 1 Then SetFrequency /scan 2 end")
    rule_set = compile_rules([parsed], lambda name: resolve_topic(name, namespace="/tb3"))
    assert rule_set.relayed == ("/tb3/odom", "/scan")
    assert rule_set.signals == {Signal("/tb3/odom", "x")}


def test_a_tier_without_a_profile_is_refused_with_its_place() -> None:
    with pytest.raises(RuleFileError) as refused:
        rules("begin\n  SetFrequency /a Desirable\nend")
    assert str(refused.value) == (
        "rules.adirf:2:3: error: Desirable has no rate without a profile; "
        "give a number, or a profile with --profile"
    )


class _ByPlace:
    """Rates and bounds that tell from which file and line they are."""

    def tier_rate(self, statement: SetFrequency, path: str, /) -> Rate:
        return Rate(len(path) + statement.span.line)

    def tier_bound(self, statement: KeepWithin, path: str, /) -> float:
        return len(path) + statement.span.line / 10


def test_a_tier_is_the_rate_that_was_given_to_its_statement() -> None:
    parsed = file("begin SetFrequency /a Desirable SetFrequency /b 3 end", "tiers.adirf")
    rates = compile_rules([parsed], resolve_topic, _ByPlace())
    assert rates.defaults == {"/a": Rate(12.0), "/b": Rate(3.0)}


def test_a_tier_of_a_bound_is_the_bound_that_was_given_to_its_statement() -> None:
    parsed = file("begin KeepWithin /a position Desirable KeepWithin /a position 30 end", "tiers.adirf")
    assert compile_rules([parsed], resolve_topic, _ByPlace()).bounds == {"/a": {"position": 11.1}}


def test_a_tier_of_a_bound_without_a_profile_is_refused_with_its_place() -> None:
    with pytest.raises(RuleFileError) as refused:
        rules("begin\n  KeepWithin /a position Desirable\nend")
    assert str(refused.value) == (
        "rules.adirf:2:3: error: Desirable has no accuracy without a profile; "
        "give a number, or a profile with --profile"
    )
