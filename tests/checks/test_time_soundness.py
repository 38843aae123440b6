# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What the checker says about rules with time is true in every history that was tried."""

from __future__ import annotations

from random import Random

from hypothesis import given, settings
from hypothesis import strategies as st

from language.evaluator.naive_time import Sample, random_condition, truths
from language.evaluator.random_rules import block, rule_file, set_frequency
from smarttestudo.checks import CheckContext
from smarttestudo.checks.rule_model import RuleModel, check_truth, read_rule_model
from smarttestudo.domain.signal import Signal, Truth
from smarttestudo.language.resolved_rules import Branch
from smarttestudo.language.syntax import RuleFile

X, LEVEL = Signal("/odom", "pose_x"), Signal("/battery_state", "level")
BORDERS = [0.0, 1.0, 100.0]
VALUES = {X: [-1.0, 0.0, 0.5, 1.0, 2.0, 100.0, 200.0], LEVEL: [0.0, 0.5, 1.0, 50.0, 100.0]}
TOPICS = ("/a", "/b")


def random_file(random: Random) -> RuleFile:
    blocks = []
    for number in range(random.randint(1, 3)):
        sets = [
            [set_frequency(topic, random.choice((1.0, 2.0))) for topic in random.sample(TOPICS, count)]
            for count in (random.randint(1, 2), random.randint(0, 2))
        ]
        condition = random_condition(random, [X, LEVEL], BORDERS, depth=random.randint(0, 3))
        blocks.append(block(condition, *sets, priority=random.choice((0, 1)), line=number + 1))
    return rule_file(blocks)


def random_history(random: Random) -> list[Sample]:
    """Values that change now and then, all known but at the start."""
    samples = [Sample(0, {X: None, LEVEL: None})]
    values = {signal: random.choice(VALUES[signal]) for signal in VALUES}
    for t_ns in range(1, 25):
        if random.random() < 0.3:
            signal = random.choice(list(VALUES))
            values = {**values, signal: random.choice(VALUES[signal])}
        samples.append(Sample(t_ns, values))
    return samples


def applying(branches: tuple[Branch, ...], history: list[Sample]) -> list[dict[int, bool | None]]:
    """For each sample, whether each branch applies."""
    found: list[dict[int, bool | None]] = [{} for _ in history]
    for branch in branches:
        for at, truth in zip(found, truths(branch.block.block.condition, history), strict=True):
            at[branch.order] = truth if truth is None else truth != branch.is_else
    return found


def assert_sound(model: RuleModel, history: list[Sample]) -> None:
    """Never and always, shadows and missing defaults; what is left out is allowed, what is wrong is not."""
    for one in model.blocks:
        seen = set(truths(one.block.condition, history))
        said = model.analysis.truths[one.order]
        assert said is not Truth.FALSE or True not in seen
        assert said is not Truth.TRUE or False not in seen
    gaps = {gap.topic for gap in model.analysis.gaps}
    for state in applying(model.branches, history):
        for shadow in model.analysis.shadows:
            if state[shadow.branch.order]:
                assert any(state[rival.order] is not False for rival in shadow.rivals)
        for topic in {topic for branch in model.branches for topic in branch.settings} - gaps:
            setting = [state[branch.order] for branch in model.branches if topic in branch.settings]
            assert True in setting or None in setting
    for check in model.checks:
        seen = set(truths(check.syntax, history))
        truth = check_truth(check, model.context.domain(check.signal))
        assert truth is not Truth.FALSE or True not in seen
        assert truth is not Truth.TRUE or False not in seen


def assert_clashes_are_found(model: RuleModel, history: list[Sample]) -> None:
    """Where two branches of one priority apply together and differ, some clash of the later one is named."""
    clashing = {clash.second.order for clash in model.analysis.clashes}
    unfinished = {one.order for one in model.analysis.unfinished}
    for state in applying(model.branches, history):
        on = [branch for branch in model.branches if state[branch.order]]
        for second in on:
            for first in on:
                differ = any(
                    first.settings[topic].rate != second.settings[topic].rate
                    for topic in first.settings.keys() & second.settings.keys()
                )
                if first.order < second.order and differ and first.block.priority == second.block.priority:
                    assert second.order in clashing or second.block.order in unfinished


@given(st.integers(0, 2**32))
@settings(max_examples=200, deadline=None)
def test_no_history_contradicts_what_the_checker_says(seed: int) -> None:
    random = Random(seed)
    model = read_rule_model([random_file(random)], CheckContext())
    for _ in range(5):
        history = random_history(random)
        assert_sound(model, history)
        assert_clashes_are_found(model, history)
