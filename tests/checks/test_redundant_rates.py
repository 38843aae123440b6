# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A rate that is said to have no effect has none: no decision changes without it."""

from __future__ import annotations

from collections.abc import Mapping
from random import Random

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from checks.rule_findings import findings_of
from checks.test_time_soundness import BORDERS, VALUES
from language.evaluator.naive_time import Sample, random_condition, truths
from language.evaluator.random_rules import block, keep_at_least, rule_file, set_frequency
from smarttestudo.checks import CheckContext
from smarttestudo.checks.rule_model import RuleModel, read_rule_model
from smarttestudo.domain.rate import Rate
from smarttestudo.domain.signal import Signal
from smarttestudo.language.syntax import RuleFile, SetFrequency, Statement

CODE = "rate-without-effect"
TOPICS = ("/a", "/b", "/c")


def random_file(random: Random) -> RuleFile:
    """Few topics and rates, so that many rates are the default's."""
    statements: list[Statement] = [set_frequency(topic, random.choice((1.0, 2.0))) for topic in TOPICS]
    if random.random() < 0.3:
        statements.append(keep_at_least(random.choice(TOPICS), 2.0))
    for number in range(random.randint(1, 4)):
        sets: list[list[SetFrequency]] = [
            [set_frequency(topic, random.choice((1.0, 2.0, 3.0))) for topic in random.sample(TOPICS, count)]
            for count in (random.randint(1, 2), random.randint(0, 2))
        ]
        condition = random_condition(random, list(VALUES), BORDERS, depth=random.randint(0, 2))
        statements.append(block(condition, *sets, priority=random.choice((0, 1)), line=number + 1))
    return rule_file(statements)


def random_history(random: Random) -> list[Sample]:
    """Values that change now and then, to unknown ones as well."""
    values: dict[Signal, float | None] = dict.fromkeys(VALUES)
    samples = [Sample(0, dict(values))]
    for t_ns in range(1, 20):
        for signal, choices in VALUES.items():
            if random.random() < 0.3:
                values[signal] = random.choice([None, *choices])
        samples.append(Sample(t_ns, dict(values)))
    return samples


def rate_at(model: RuleModel, topic: str, truth_of: Mapping[int, bool | None], removed: set[int]) -> Rate:
    """Rules 3 to 6 of the language, where the truth of each branch is given."""
    setting = [
        one
        for one in model.branches
        if topic in one.settings and id(one.settings[topic].statement) not in removed
    ]
    ranked = [(one.block.priority, one.rate(topic) or Rate(0.0), truth_of[one.order]) for one in setting]
    default = model.defaults[topic].rate or Rate(0.0)
    priority, rate = max(((p, r) for p, r, truth in ranked if truth), default=(-99, default))
    feared = [r for p, r, truth in ranked if truth is None and p >= priority]
    floor = model.floors.get(topic)
    return max([rate, *feared]).at_least(floor.rate.hz if floor and floor.rate else 0.0)


@settings(max_examples=120, deadline=None)
@example(387_138)
@given(st.integers(0, 2**32))
def test_no_rate_changes_without_those_that_have_no_effect(seed: int) -> None:
    random = Random(seed)
    model = read_rule_model([random_file(random)], CheckContext())
    redundant = {id(one.setting.statement) for one in model.analysis.redundant_rates}
    if not redundant:
        return
    for _ in range(5):
        history = random_history(random)
        found = {one.order: truths(one.block.block.condition, history) for one in model.branches}
        for index in range(len(history)):
            at = {
                one.order: None if found[one.order][index] is None else found[one.order][index] != one.is_else
                for one in model.branches
            }
            for topic in TOPICS:
                assert rate_at(model, topic, at, redundant) == rate_at(model, topic, at, set())


ZONE = "CheckValue /odom pose_x < 6"


@pytest.mark.parametrize(
    ("rules", "expected"),
    [
        pytest.param(f"If {ZONE} Then SetFrequency /odom 10 EndIf", 1, id="the default again"),
        pytest.param(
            f"If {ZONE} Then SetFrequency /odom 4 Else SetFrequency /odom 10 EndIf",
            1,
            id="the default in Else",
        ),
        pytest.param(
            f"If {ZONE} Then SetFrequency /odom 10 EndIf "
            "If CheckValue /odom pose_x > 7 Then SetFrequency /odom 4 EndIf",
            1,
            id="beside a lower rate elsewhere",
        ),
        pytest.param(
            f"If {ZONE} Then SetFrequency /odom 10 EndIf "
            "If CheckValue /odom pose_y > 7 Then SetFrequency /odom 4 EndIf",
            0,
            id="over a lower rate",
        ),
        pytest.param(
            f"If {ZONE} Then SetFrequency /odom 10 EndIf "
            "Rule Priority 1 If CheckValue /odom pose_y > 7 Then SetFrequency /odom 4 EndIf",
            1,
            id="under a lower rate of higher priority",
        ),
        pytest.param(
            f"If {ZONE} Then SetFrequency /odom 10 EndIf "
            "If CheckValue /odom pose_y > 7 Then SetFrequency /odom 40 EndIf",
            1,
            id="under a higher rate",
        ),
        pytest.param(
            f"Rule Priority 1 If {ZONE} Then SetFrequency /odom 10 EndIf "
            "If CheckValue /odom pose_y > 7 Then SetFrequency /odom 40 EndIf",
            0,
            id="over a higher rate of lower priority",
        ),
        pytest.param(
            f"Rule Priority 1 If {ZONE} Then SetFrequency /odom 10 EndIf "
            "If CheckValue /battery_state level < 0 Then SetFrequency /odom 40 EndIf",
            0,
            id="over one that never holds and is feared",
        ),
        pytest.param(f"If {ZONE} Then SetFrequency /odom Desirable EndIf", 0, id="a level"),
        pytest.param(f"Disabled If {ZONE} Then SetFrequency /odom 10 EndIf", 0, id="switched off"),
        pytest.param(
            f"If {ZONE} Then SetFrequency /odom 10 EndIf Disabled If CheckValue /odom pose_y > 7 "
            "Then SetFrequency /odom 4 EndIf",
            1,
            id="over a lower rate that is switched off",
        ),
        pytest.param(f"If {ZONE} Then SetFrequency /scan Full EndIf", 0, id="a topic without a default"),
    ],
)
def test_a_rate_has_no_effect_where_it_overrules_nothing(rules: str, expected: int) -> None:
    named = rules.replace("Rule Priority", 'Rule "a" Priority')
    found = findings_of(f"begin SetFrequency /odom 10 {named} end")
    assert sum(one.code == CODE for one in found) == expected


def test_a_rule_of_nothing_else_is_named_and_a_bound_or_a_recording_keeps_it() -> None:
    text = f'begin SetFrequency /odom 10\nRule "Calm" If {ZONE} Then SetFrequency /odom 10 {{}} end'
    (rule,) = findings_of(text.format(""))
    assert rule.message == '"Calm" changes nothing: /odom is 10 Hz by default (line 1)'
    assert rule.fix is None
    for action in ("KeepWithin /odom position 0.1", 'Record "calm" Before 1 s After 1 s'):
        found = [one for one in findings_of(text.format(action)) if one.code == CODE]
        assert [one.message for one in found] == [
            "/odom is 10 Hz without this as well, by the default (line 1)"
        ]
